/// One of several parts of a list.
#pragma once

#include <cstddef>
#include <cstdio>
#include <string>

#include "usage_error.h"

struct Part {
    std::size_t number = 1, count = 1;  ///< the first of 3: 1 and 3

    /// "1/3"
    /// @throws igeo::Error  InvalidArgument
    static Part parse(const std::string& text) {
        Part part;
        char rest = 0;
        if (text.find('-') != std::string::npos ||
            std::sscanf(text.c_str(), "%zu/%zu%c", &part.number, &part.count, &rest) != 2 ||
            !part.valid())
            usageError("'" + text + "' is not K/N with K from 1 to N",
                       "write for instance 1/4, 2/4, 3/4 and 4/4 for the parts of a whole");
        return part;
    }

    /// The part of a list of n: parts are consecutive, and their lengths differ by one at most.
    std::size_t begin(std::size_t n) const { return n * (number - 1) / count; }
    std::size_t end(std::size_t n) const { return n * number / count; }

    /// The part of 1.
    double begin() const { return double(number - 1) / double(count); }
    double end() const { return double(number) / double(count); }

    bool valid() const {
        constexpr std::size_t kMost = 1000000;
        return number >= 1 && number <= count && count <= kMost;
    }
    bool whole() const { return count == 1; }
    /// "2 of 3"
    std::string text() const { return std::to_string(number) + " of " + std::to_string(count); }
};
