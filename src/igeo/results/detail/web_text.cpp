#include <igeo/results/detail/web_text.h>

#include <fmt/core.h>
#include <igeo/io/detail/base64.h>

#include <cstdint>

namespace igeo {

namespace {

/// The code point at the start of `text`, and its length in bytes; 0: invalid UTF-8.
struct CodePoint {
    std::uint32_t code = 0;
    std::size_t length = 0;
};

CodePoint codePointAt(std::string_view text) {
    const auto byte = [&](std::size_t k) { return std::uint32_t(std::uint8_t(text[k])); };
    const std::uint32_t first = byte(0);
    if (first < 0x80) return {first, 1};
    const std::size_t length = first >> 5 == 6    ? 2
                               : first >> 4 == 14 ? 3
                               : first >> 3 == 30 ? 4
                                                  : 0;
    if (length == 0 || text.size() < length) return {};
    std::uint32_t code = first & (0x7fu >> length);
    for (std::size_t k = 1; k < length; ++k) {
        if (byte(k) >> 6 != 2) return {};
        code = code << 6 | (byte(k) & 0x3f);
    }
    constexpr std::uint32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};
    if (code < kLeast[length] || code > 0x10ffff || (code >= 0xd800 && code < 0xe000)) return {};
    return {code, length};
}

/// Calls each(code) for all code points, U+FFFD for invalid bytes.
template <typename Each>
void forCodePoints(std::string_view text, const Each& each) {
    while (!text.empty()) {
        const CodePoint p = codePointAt(text);
        each(p.length > 0 ? p.code : 0xfffdu);
        text.remove_prefix(p.length > 0 ? p.length : 1);
    }
}

void putUtf8(std::string& text, std::uint32_t code) {
    const int more = code < 0x80 ? 0 : code < 0x800 ? 1 : code < 0x10000 ? 2 : 3;
    constexpr std::uint32_t kLead[] = {0, 0xc0, 0xe0, 0xf0};
    text += char(kLead[more] | code >> 6 * more);
    for (int k = more - 1; k >= 0; --k) text += char(0x80 | (code >> 6 * k & 0x3f));
}

}  // namespace

std::string utf8(std::string_view bytes) {
    std::string text;
    forCodePoints(bytes, [&](std::uint32_t code) { putUtf8(text, code); });
    return text;
}

std::string htmlText(std::string_view text) {
    std::string html;
    for (const char c : utf8(text)) {
        if (c == '<' || c == '>' || c == '&' || c == '"' || c == '\'')
            html += fmt::format("&#{};", int(c));
        else
            html += c;
    }
    return html;
}

std::string jsonString(std::string_view text) {
    std::string json = "\"";
    forCodePoints(text, [&](std::uint32_t code) {
        const bool plain =
            code >= 0x20 && code < 0x7f && code != '"' && code != '\\' && code != '<';
        if (plain)
            json += char(code);
        else if (code < 0x10000)
            json += fmt::format("\\u{:04x}", code);
        else
            json += fmt::format("\\u{:04x}\\u{:04x}", 0xd800 + ((code - 0x10000) >> 10),
                                0xdc00 + (code & 0x3ff));
    });
    return json + '"';
}

std::string pngAddress(std::string_view png) { return "data:image/png;base64," + base64(png); }

std::string filledIn(std::string_view text, const std::map<std::string, std::string>& values) {
    std::string all;
    while (true) {
        const std::size_t open = text.find("{{"), close = text.find("}}", open);
        const auto value = close < text.size()
                               ? values.find(std::string(text.substr(open + 2, close - open - 2)))
                               : values.end();
        if (open >= text.size()) return all += text;
        all += text.substr(0, open);
        if (value != values.end()) all += value->second;
        text.remove_prefix(value != values.end() ? close + 2 : open + 2);
        if (value == values.end()) all += "{{";
    }
}

}  // namespace igeo
