/// For what holds a band and a field on it, which points to the band.
#pragma once

namespace igeo::test {

/// Stays where it is made: neither copied nor moved.
struct Pinned {
    Pinned() = default;
    Pinned(const Pinned&) = delete;
    Pinned& operator=(const Pinned&) = delete;
};

}  // namespace igeo::test
