/// VDB files with a directory. Internal.
#pragma once

#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/openvdb.h>

#include <istream>
#include <string>
#include <vector>

namespace igeo {

/// A file with a directory of its grids. OpenVDB's own File reads past the end of a truncated file
/// and takes the missing bytes for zeros. Here the stream throws, and the directory is first
/// compared with the size of the file.
class VdbArchive : openvdb::io::Archive {
public:
    struct Entry {
        std::string name;  ///< unique in the file
        std::string type;  ///< of its tree, as Tree_float_5_4_3
        /// Its metadata only; null: of a type that OpenVDB does not have
        openvdb::GridBase::ConstPtr grid;
    };

    /// Reads the directory, if there is one.
    /// @param in  the open file, with exceptions for failbit and badbit
    /// @throws Error  BadInput where an entry of the directory points out of the file or backward
    VdbArchive(const std::string& file, std::istream& in);

    /// False: the file was written to a stream.
    bool hasDirectory() const { return inputHasGridOffsets(); }
    /// In the order of the file.
    std::vector<Entry> entries();
    /// @throws Error  BadInput where no grid has that name
    openvdb::GridBase::Ptr read(const std::string& name);

private:
    struct Descriptor : openvdb::io::GridDescriptor {
        openvdb::GridBase::Ptr create() const;
    };

    void readDirectory();
    void readDescriptor(Descriptor& d);
    const Descriptor& find(const std::string& name) const;
    openvdb::GridBase::Ptr readOne(const Descriptor& d);

    const std::string file_;
    std::istream& in_;
    std::vector<Descriptor> grids_;  ///< in the order of the file
};

}  // namespace igeo
