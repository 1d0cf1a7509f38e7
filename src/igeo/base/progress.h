/// Progress reports and cancellation of long work.
#pragma once

#include <igeo/base/error.h>

namespace igeo {

/// Receives progress; the default does nothing and never cancels. Calls may come from any thread.
class Progress {
public:
    virtual ~Progress() = default;

    /// `fraction` of the stage `name` is done, in [0, 1].
    virtual void update(const char* name, double fraction) {
        (void)name;
        (void)fraction;
    }
    /// The work since the last call was the stage `name`; for tables of times per stage.
    virtual void finished(const char* name) { (void)name; }
    virtual bool cancelled() const { return false; }

    void throwIfCancelled() const {
        if (cancelled()) throw Error(Error::Kind::Cancelled, "interrupted");
    }

    /// For callers that need neither.
    static Progress& none() {
        static Progress instance;
        return instance;
    }
};

/// Progress for stages that run side by side: it passes cancellation on to them and drops their
/// reports.
class CancelOnly : public Progress {
public:
    explicit CancelOnly(const Progress& whole) : whole_(whole) {}
    bool cancelled() const override { return whole_.cancelled(); }

private:
    const Progress& whole_;
};

}  // namespace igeo
