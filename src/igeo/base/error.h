/// The one exception type of the library.
#pragma once

#include <stdexcept>
#include <string>

namespace igeo {

/// Says what happened, where, the value seen, the value allowed, and the remedy.
class Error : public std::runtime_error {
public:
    enum class Kind {
        InvalidArgument,  ///< a parameter or option out of its range
        BadInput,         ///< a file, grid or surface that cannot be used
        Io,               ///< reading or writing failed
        Numerical,        ///< a computation that should have converged did not
        Cancelled,        ///< stopped through Progress
        Internal          ///< a broken invariant: please report it
    };

    /// @param what   one sentence: what is wrong, the value seen and the value allowed
    /// @param remedy the remedy, one line; may be empty
    Error(Kind kind, const std::string& what, std::string remedy = {})
        : std::runtime_error(what), kind_(kind), remedy_(std::move(remedy)) {}

    Kind kind() const { return kind_; }
    const std::string& remedy() const { return remedy_; }

private:
    Kind kind_;
    std::string remedy_;
};

/// Returns what `work` returns. Puts `what` in front of the errors that it throws, except
/// Cancelled.
template <typename Work>
auto naming(const std::string& what, const Work& work) {
    try {
        return work();
    } catch (const Error& e) {
        if (e.kind() == Error::Kind::Cancelled) throw;
        throw Error(e.kind(), what + ": " + e.what(), e.remedy());
    }
}

}  // namespace igeo
