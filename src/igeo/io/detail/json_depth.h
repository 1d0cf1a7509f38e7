/// Limits of JSON files: depth of nesting, and no member twice. Internal.
#pragma once

#include <igeo/base/error.h>

#include <set>
#include <string>
#include <vector>

namespace igeo {

/// Copying and printing JSON take stack for each level.
/// @param depth  as nlohmann::json's parser passes it to its callback
/// @throws Error  BadInput
inline void requireShallow(int depth, const std::string& file) {
    constexpr int kDeepest = 100;
    if (depth > kDeepest)
        throw Error(
            Error::Kind::BadInput,
            file + ": lists and objects are nested more than " + std::to_string(kDeepest) + " deep",
            "write the file again; nothing that is read from it is so deep");
}

/// A callback for nlohmann::json's parser that refuses deep nesting and repeated members, of which
/// a reader would see only one.
/// @throws Error  BadInput
template <typename Json>
class JsonGuard {
public:
    explicit JsonGuard(std::string file) : file_(std::move(file)) {}

    bool operator()(int depth, typename Json::parse_event_t event, const Json& value) {
        using Event = typename Json::parse_event_t;
        requireShallow(depth, file_);
        if (event == Event::object_start) members_.emplace_back();
        if (event == Event::object_end) members_.pop_back();
        if (event != Event::key) return true;
        const std::string name = value.template get<std::string>();
        if (!members_.back().insert(name).second)
            throw Error(Error::Kind::BadInput, file_ + ": '" + name + "' is twice in one object",
                        "keep one; a list holds several values");
        return true;
    }

private:
    std::string file_;
    std::vector<std::set<std::string>> members_;  // of the open objects
};

}  // namespace igeo
