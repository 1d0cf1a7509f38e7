#include "run_program.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <system_error>
#include <utility>

namespace igeo::test {
namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

[[noreturn]] void fail(const char* what) {
    throw std::system_error(errno, std::generic_category(), what);
}

/// A file descriptor, closed at the end.
class Descriptor {
public:
    Descriptor() = default;
    explicit Descriptor(int fd) : fd_(fd) {}
    ~Descriptor() { close(); }
    Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
    Descriptor& operator=(Descriptor&& other) noexcept {
        std::swap(fd_, other.fd_);
        return *this;
    }
    int get() const { return fd_; }
    bool isOpen() const { return fd_ >= 0; }
    void close() {
        if (fd_ >= 0) ::close(std::exchange(fd_, -1));
    }

private:
    int fd_ = -1;
};

struct Pipe {
    Descriptor read, write;
    Pipe() {
        int fds[2];
        if (pipe2(fds, O_CLOEXEC) != 0) fail("pipe");
        read = Descriptor(fds[0]);
        write = Descriptor(fds[1]);
    }
};

[[noreturn]] void failInChild(const std::string& what) {
    std::perror(what.c_str());
    _exit(127);
}

void redirect(const std::string& file, int flags, int target) {
    const int fd = open(file.c_str(), flags, 0644);
    if (fd < 0 || dup2(fd, target) < 0) failInChild(file);
}

/// Between fork and exec: sets up the process and becomes the program.
[[noreturn]] void becomeProgram(const Command& command, const Pipe& in, const Pipe& out,
                                const Pipe& err) {
    dup2(err.write.get(), STDERR_FILENO);
    dup2(out.write.get(), STDOUT_FILENO);
    dup2(in.read.get(), STDIN_FILENO);
    if (!command.stdinFile.empty()) redirect(command.stdinFile, O_RDONLY, STDIN_FILENO);
    if (!command.stdoutFile.empty())
        redirect(command.stdoutFile, O_WRONLY | O_CREAT | O_TRUNC, STDOUT_FILENO);
    if (!command.workingDirectory.empty() && chdir(command.workingDirectory.c_str()) != 0)
        failInChild(command.workingDirectory);
    for (const auto& [name, value] : command.environment) setenv(name.c_str(), value.c_str(), 1);
    std::signal(SIGPIPE, SIG_DFL);
    std::signal(SIGINT, SIG_DFL);  // a test runner in the background has it ignored
    if (command.fileSizeLimit) {
        const rlimit limit{*command.fileSizeLimit, *command.fileSizeLimit};
        std::signal(SIGXFSZ, SIG_IGN);
        if (setrlimit(RLIMIT_FSIZE, &limit) != 0) failInChild("setrlimit");
    }
    std::vector<char*> argv{const_cast<char*>(command.program.c_str())};
    for (const std::string& arg : command.args) argv.push_back(const_cast<char*>(arg.c_str()));
    argv.push_back(nullptr);
    execvp(argv[0], argv.data());
    failInChild(command.program);
}

/// Appends what can be read now; closes the descriptor at the end of the stream.
void drain(Descriptor& fd, std::string& text) {
    char buffer[65536];
    const ssize_t count = read(fd.get(), buffer, sizeof buffer);
    if (count > 0)
        text.append(buffer, static_cast<std::size_t>(count));
    else if (count == 0 || errno != EINTR)
        fd.close();
}

/// Writes what the pipe takes now; closes it when all is written or no program reads any more.
void feed(Descriptor& fd, const std::string& bytes, std::size_t& written) {
    const ssize_t count = write(fd.get(), bytes.data() + written, bytes.size() - written);
    if (count > 0) written += static_cast<std::size_t>(count);
    const bool again = count < 0 && (errno == EINTR || errno == EAGAIN);
    if (written == bytes.size() || (count < 0 && !again)) fd.close();
}

/// The parent's side of a running program.
class Conversation {
public:
    Conversation(const Command& command, pid_t pid, Descriptor in, Descriptor out, Descriptor err)
        : command_(command),
          pid_(pid),
          in_(std::move(in)),
          out_(std::move(out)),
          err_(std::move(err)) {
        fcntl(in_.get(), F_SETFL, O_NONBLOCK);
        if (command_.stdinBytes.empty()) in_.close();
    }

    /// Exchanges data and sends signals until the program has ended.
    Result finish() {
        int status = 0;
        while (true) {
            const pid_t ended = waitpid(pid_, &status, WNOHANG);
            if (ended < 0 && errno != EINTR) fail("waitpid");
            if (ended == pid_) break;
            sendDueSignals();
            exchange(kPollMilliseconds);
        }
        result_.seconds = secondsSince(start_);
        if (signalSent_) result_.secondsAfterSignal = secondsSince(signalTime_);
        in_.close();
        while (exchange(0)) {
        }
        if (WIFEXITED(status)) result_.exitCode = WEXITSTATUS(status);
        if (WIFSIGNALED(status)) result_.signal = WTERMSIG(status);
        return std::move(result_);
    }

private:
    static constexpr int kPollMilliseconds = 2;

    void sendDueSignals() {
        const double elapsed = secondsSince(start_);
        if (command_.signal != 0 && !signalSent_ && elapsed >= command_.signalDelay) {
            signalTime_ = Clock::now();
            signalSent_ = true;
            kill(pid_, command_.signal);
        }
        if (elapsed > command_.timeout && !result_.timedOut) {
            result_.timedOut = true;
            kill(pid_, SIGKILL);
        }
    }

    /// Moves data that is ready within the time; false if there was none.
    bool exchange(int milliseconds) {
        pollfd fds[] = {{in_.get(), POLLOUT, 0}, {out_.get(), POLLIN, 0}, {err_.get(), POLLIN, 0}};
        if (poll(fds, 3, milliseconds) <= 0) return false;
        if (fds[0].revents != 0) feed(in_, command_.stdinBytes, written_);
        if (fds[1].revents != 0) drain(out_, result_.out);
        if (fds[2].revents != 0) drain(err_, result_.err);
        return true;
    }

    const Command& command_;
    const pid_t pid_;
    Descriptor in_, out_, err_;
    const Clock::time_point start_ = Clock::now();
    Clock::time_point signalTime_;
    bool signalSent_ = false;
    std::size_t written_ = 0;
    Result result_;
};

}  // namespace

Result run(const Command& command) {
    std::signal(SIGPIPE, SIG_IGN);  // a program that does not read its input must not end the tests
    Pipe in, out, err;
    const pid_t pid = fork();
    if (pid < 0) fail("fork");
    if (pid == 0) becomeProgram(command, in, out, err);
    in.read.close();
    out.write.close();
    err.write.close();
    return Conversation(command, pid, std::move(in.write), std::move(out.read), std::move(err.read))
        .finish();
}

}  // namespace igeo::test
