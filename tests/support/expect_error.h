/// Errors are promises too: their kind and what they tell the user.
#pragma once

#include <igeo/base/error.h>
#include <support/catch.h>

#include <string>
#include <vector>

namespace igeo::test {

/// Runs `f`, which has to throw an Error of `kind` whose message or remedy holds every phrase.
template <typename F>
void expectError(Error::Kind kind, const std::vector<std::string>& phrases, const F& f) {
    try {
        f();
    } catch (const Error& e) {
        const std::string text = std::string(e.what()) + " | " + e.remedy();
        INFO(text);
        CHECK(int(e.kind()) == int(kind));
        for (const std::string& phrase : phrases) {
            INFO("should hold: " << phrase);
            CHECK(text.find(phrase) != std::string::npos);
        }
        return;
    }
    FAIL_CHECK("no error, though one was due: " << (phrases.empty() ? "" : phrases.front()));
}

}  // namespace igeo::test
