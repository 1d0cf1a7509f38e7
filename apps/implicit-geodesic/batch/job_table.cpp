#include "batch/job_table.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

namespace fs = std::filesystem;

namespace {

/// TableCells separated by commas, semicolons or tabs, row by row (RFC 4180).
class TableCells {
public:
    explicit TableCells(const std::string& file) : file_(file) {
        std::ifstream in(file, std::ios::binary);
        std::error_code ignored;
        if (!in || fs::is_directory(file, ignored))
            throw igeo::Error(
                igeo::Error::Kind::Io,
                "cannot read '" + file + "': " + (in ? "it is a folder" : std::strerror(errno)),
                "check the name and its permissions");
        text_.assign(std::istreambuf_iterator<char>(in), {});
        if (text_.starts_with("\xef\xbb\xbf")) text_.erase(0, 3);  // a byte order mark
        const std::string first = text_.substr(0, text_.find('\n'));
        for (const char c : {';', '\t'})
            if (first.find(',') == first.npos && first.find(c) != first.npos) separator_ = c;
    }

    /// The next row that is not empty.
    bool next(std::vector<std::string>& row) {
        do {
            row.assign(1, "");
            if (at_ >= text_.size()) return false;
            place_ = ++line_;
            while (at_ < text_.size() && text_[at_] != '\n') take(row);
            ++at_;
        } while (row.size() == 1 && row[0].empty());
        return true;
    }
    std::string where() const { return file_ + ", line " + std::to_string(place_); }

private:
    void take(std::vector<std::string>& row) {
        const char c = text_[at_++];
        if (c == separator_)
            row.emplace_back();
        else if (c == '"' && row.back().empty())
            takeQuoted(row.back());
        else if (c != '\r')
            row.back() += c;
    }
    void takeQuoted(std::string& cell) {
        for (; at_ < text_.size(); ++at_) {
            if (text_[at_] == '\n') ++line_;
            if (text_[at_] == '"' && text_.compare(at_, 2, "\"\"") != 0) {
                ++at_;
                return;
            }
            if (text_[at_] == '"') ++at_;
            cell += text_[at_];
        }
        inputError(where() + ": a quote has no end", "close it");
    }

    std::string file_, text_;
    char separator_ = ',';
    std::size_t at_ = 0, line_ = 0, place_ = 0;
};

bool isLike(const std::string& name, const std::string& pattern) {
    // star: position of the last *; taken: end of its match.
    std::size_t n = 0, p = 0, star = pattern.npos, taken = 0;
    while (n < name.size()) {
        if (p < pattern.size() && pattern[p] == '*') {
            star = p++, taken = n;
        } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == name[n])) {
            ++n, ++p;
        } else if (star != pattern.npos) {
            n = ++taken, p = star + 1;
        } else {
            return false;
        }
    }
    return pattern.find_first_not_of('*', p) == pattern.npos;
}

/// A flag: true or false.
Json valueOf(const std::string& cell) {
    if (cell == "true" || cell == "false") return cell == "true";
    return cell;
}

}  // namespace

Json jobsOfTable(const std::string& file) {
    TableCells cells(file);
    std::vector<std::string> head, row;
    if (!cells.next(head) || std::count(head.begin(), head.end(), "name") != 1)
        inputError(file + ": the first line names no column 'name'",
                   "begin with a line such as name,mesh,seed,output");
    Json jobs = Json::array();
    while (cells.next(row)) {
        if (row.size() != head.size())
            inputError(cells.where() + ": " + std::to_string(row.size()) + " cells for " +
                           std::to_string(head.size()) + " columns",
                       "quote values that hold commas, as \"0,0,1\"");
        Json job = Json::object();
        for (std::size_t k = 0; k < row.size(); ++k) {
            if (job.contains(head[k]))
                inputError(file + ": two columns are named '" + head[k] + "'", "keep one");
            if (!row[k].empty()) job[head[k]] = valueOf(row[k]);
        }
        jobs.push_back(std::move(job));
    }
    return jobs;
}

std::vector<fs::path> filesLike(const fs::path& pattern, const fs::path& from) {
    const fs::path folder = pattern.parent_path();
    const std::string name = pattern.filename().string();
    std::vector<fs::path> files;
    std::error_code error;
    for (fs::directory_iterator entry(from / folder, error), end; !error && entry != end;
         entry.increment(error)) {
        const std::string found = entry->path().filename().string();
        std::error_code ignored;
        const bool hidden = found[0] == '.' && name[0] != '.';
        if (!hidden && isLike(found, name) && entry->is_regular_file(ignored))
            files.push_back(folder / found);
    }
    std::sort(files.begin(), files.end());
    return files;
}
