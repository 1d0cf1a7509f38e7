/// Names from files, which may hold any bytes.
#pragma once

#include <algorithm>
#include <string>

inline bool isControl(char c) {
    const auto code = static_cast<unsigned char>(c);
    return code < 0x20 || code == 0x7f;
}

inline bool hasControls(const std::string& text) {
    return std::any_of(text.begin(), text.end(), isControl);
}

/// With \x1b and the like in place of control characters, which would act on the terminal.
inline std::string printable(const std::string& text) {
    constexpr const char* kDigits = "0123456789abcdef";
    std::string shown;
    for (const char c : text)
        if (isControl(c))
            shown += {'\\', 'x', kDigits[static_cast<unsigned char>(c) >> 4], kDigits[c & 15]};
        else
            shown += c;
    return shown;
}
