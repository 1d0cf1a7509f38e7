/// Base64 (RFC 4648) for binary data in XML.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace igeo {

inline constexpr std::string_view kBase64 =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

inline std::string base64(std::string_view bytes) {
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const auto byte = [&](std::size_t k) {
            return k < bytes.size() ? std::uint32_t(std::uint8_t(bytes[k])) : 0;
        };
        const std::uint32_t bits = byte(i) << 16 | byte(i + 1) << 8 | byte(i + 2);
        for (unsigned k = 0; k < 4; ++k) text += kBase64[bits >> (18 - 6 * k) & 63];
    }
    const std::size_t padding = (3 - bytes.size() % 3) % 3;
    text.replace(text.size() - padding, padding, padding, '=');
    return text;
}

/// The decoded bytes; empty where a character is no digit or digits are missing. Blanks are
/// skipped.
inline std::optional<std::string> fromBase64(std::string_view text) {
    static const auto values = [] {
        std::array<std::int8_t, 256> table;
        table.fill(-1);
        for (std::size_t i = 0; i < kBase64.size(); ++i)
            table[std::uint8_t(kBase64[i])] = std::int8_t(i);
        return table;
    }();
    std::string bytes;
    bytes.reserve(text.size() / 4 * 3);
    std::uint32_t bits = 0;
    unsigned digits = 0, padding = 0;
    for (const char c : text) {
        if (c == ' ' || c == '\t' || c == '\r' || c == '\n') continue;
        const int value = c == '=' ? 0 : values[std::uint8_t(c)];
        if (value < 0 || (padding > 0 && c != '=')) return {};
        padding += c == '=';
        bits = bits << 6 | std::uint32_t(value);
        if (++digits % 4 != 0) continue;
        if (padding > 2) return {};
        for (unsigned k = 0; k < 3 - padding; ++k) bytes += char(bits >> (16 - 8 * k) & 0xff);
        bits = 0;
    }
    if (digits % 4 != 0) return {};
    return bytes;
}

}  // namespace igeo
