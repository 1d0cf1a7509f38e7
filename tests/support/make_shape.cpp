// Writes the level sets of shapes.h, and the broken ones of bad_inputs.h, as VDB files.
#include <cstdlib>
#include <functional>
#include <iostream>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "bad_inputs.h"
#include "shapes.h"
#include "vdb_file.h"

namespace {

using namespace igeo::test;
using openvdb::Vec3d;

struct UsageError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

double parseNumber(const std::string& text) {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (text.empty() || *end != '\0') throw UsageError("'" + text + "' is not a number");
    return value;
}

std::vector<double> parseNumbers(const std::string& text, std::size_t count) {
    std::vector<double> numbers;
    std::istringstream list(text);
    for (std::string item; std::getline(list, item, ',');) numbers.push_back(parseNumber(item));
    if (numbers.size() != count)
        throw UsageError("'" + text + "' should be " + std::to_string(count) +
                         " numbers with commas between them");
    return numbers;
}

Vec3d parseVector(const std::string& text) { return Vec3d(parseNumbers(text, 3).data()); }

/// The values of --param, each with a default; remembers which were asked for.
class Parameters {
public:
    void set(const std::string& assignment) {
        const auto equals = assignment.find('=');
        if (equals == std::string::npos)
            throw UsageError("--param " + assignment + ": expected key=value");
        given_[assignment.substr(0, equals)] = assignment.substr(equals + 1);
    }
    double number(const std::string& key, double fallback) {
        known_.insert(key);
        return given_.count(key) ? parseNumber(given_[key]) : fallback;
    }
    Vec3d vector(const std::string& key, const Vec3d& fallback) {
        known_.insert(key);
        return given_.count(key) ? parseVector(given_[key]) : fallback;
    }
    void requireAllKnown() const {
        for (const auto& [key, value] : given_)
            if (!known_.count(key)) throw UsageError("--param " + key + ": no such parameter");
    }

private:
    std::map<std::string, std::string> given_;
    std::set<std::string> known_;
};

struct ShapeEntry {
    std::string name;
    std::string parameters;
    std::function<Shape(Parameters&)> make;
};

const std::vector<ShapeEntry>& shapeTable() {
    static const Vec3d kOrigin(0.0);
    static const std::vector<ShapeEntry> table{
        {"sphere", "center=0,0,0 radius=1",
         [](Parameters& p) { return sphere(p.vector("center", kOrigin), p.number("radius", 1)); }},
        {"torus", "center=0,0,0 major=1 minor=0.4",
         [](Parameters& p) {
             return torus(p.vector("center", kOrigin), p.number("major", 1),
                          p.number("minor", 0.4));
         }},
        {"trefoil", "center=0,0,0 scale=0.3 tube=0.12",
         [](Parameters& p) {
             return trefoilTube(p.vector("center", kOrigin), p.number("scale", 0.3),
                                p.number("tube", 0.12));
         }},
        {"rounded-box", "center=0,0,0 half-size=0.9,0.7,0.5 radius=0.2",
         [](Parameters& p) {
             return roundedBox(p.vector("center", kOrigin),
                               p.vector("half-size", Vec3d(0.9, 0.7, 0.5)),
                               p.number("radius", 0.2));
         }},
        {"box", "center=0,0,0 half-size=0.9,0.7,0.5",
         [](Parameters& p) {
             return box(p.vector("center", kOrigin), p.vector("half-size", Vec3d(0.9, 0.7, 0.5)));
         }},
        {"two-spheres", "center0=-0.7,0,0 radius0=0.5 center1=0.7,0,0 radius1=0.5",
         [](Parameters& p) {
             return twoSpheres(p.vector("center0", Vec3d(-0.7, 0, 0)), p.number("radius0", 0.5),
                               p.vector("center1", Vec3d(0.7, 0, 0)), p.number("radius1", 0.5));
         }},
        {"thin-sheet", "center=0,0,0 half-x=0.8 half-y=0.6 thickness=0.2",
         [](Parameters& p) {
             return thinSheet(p.vector("center", kOrigin), p.number("half-x", 0.8),
                              p.number("half-y", 0.6), p.number("thickness", 0.2));
         }},
        {"plane-patch", "center=0,0,0 normal=0,0,1 size=2",
         [](Parameters& p) {
             return planePatch(p.vector("center", kOrigin), p.vector("normal", Vec3d(0, 0, 1)),
                               p.number("size", 2));
         }},
        {"cylinder", "center=0,0,0 radius=0.5 half-height=1",
         [](Parameters& p) {
             return cylinder(p.vector("center", kOrigin), p.number("radius", 0.5),
                             p.number("half-height", 1));
         }},
    };
    return table;
}

template <typename Table>
auto findIn(const Table& table, const std::string& name, std::string Table::value_type::*key) {
    for (auto entry = table.begin(); entry != table.end(); ++entry)
        if ((*entry).*key == name) return entry;
    throw UsageError("unknown shape or kind '" + name + "'");
}

struct Options {
    std::string shape, badKind, output;
    double voxelSize = 0.05, halfWidth = 3, angle = 0;
    Vec3d axis{0, 0, 1}, translation{0, 0, 0};
    std::string name = "psi", gridClass = "level-set";
    bool asHalf = false, asDouble = false, help = false;
    Parameters parameters;
};

std::string usage() {
    std::ostringstream text;
    text << "usage: make_shape SHAPE -o FILE.vdb [options]\n"
            "       make_shape bad KIND -o FILE.vdb\n\n"
            "  --voxel-size S         world units, default 0.05\n"
            "  --half-width N         voxels on each side of the surface, default 3\n"
            "  --rotate AX,AY,AZ,DEG  turn the voxels about an axis, not the shape\n"
            "  --translate X,Y,Z      world position of voxel 0,0,0\n"
            "  --name NAME            grid name, default psi\n"
            "  --grid-class CLASS     level-set (default), fog or unknown\n"
            "  --half                 save values as 16-bit floats\n"
            "  --double               64-bit grid\n"
            "  --param KEY=VALUE      shape parameter, repeat as needed\n\n"
            "SHAPE, with its parameters and their defaults:\n";
    for (const auto& entry : shapeTable())
        text << "  " << entry.name << std::string(13 - entry.name.size(), ' ') << entry.parameters
             << "\n";
    text << "\nKIND:\n";
    for (const auto& entry : badInputs())
        text << "  " << entry.kind << std::string(16 - entry.kind.size(), ' ') << entry.what
             << "\n";
    return text.str();
}

Options parse(const std::vector<std::string>& args) {
    Options options;
    std::vector<std::string> words;
    const std::map<std::string, std::function<void(const std::string&)>> withValue{
        {"-o", [&](const std::string& v) { options.output = v; }},
        {"--output", [&](const std::string& v) { options.output = v; }},
        {"--voxel-size", [&](const std::string& v) { options.voxelSize = parseNumber(v); }},
        {"--half-width", [&](const std::string& v) { options.halfWidth = parseNumber(v); }},
        {"--rotate",
         [&](const std::string& v) {
             const auto n = parseNumbers(v, 4);
             options.axis = Vec3d(n.data());
             options.angle = n[3];
         }},
        {"--translate", [&](const std::string& v) { options.translation = parseVector(v); }},
        {"--name", [&](const std::string& v) { options.name = v; }},
        {"--grid-class", [&](const std::string& v) { options.gridClass = v; }},
        {"--param", [&](const std::string& v) { options.parameters.set(v); }},
    };
    for (std::size_t i = 0; i < args.size(); ++i) {
        const auto option = withValue.find(args[i]);
        if (option != withValue.end()) {
            if (i + 1 == args.size()) throw UsageError(args[i] + " needs a value");
            option->second(args[++i]);
        } else if (args[i] == "--half") {
            options.asHalf = true;
        } else if (args[i] == "--double") {
            options.asDouble = true;
        } else if (args[i] == "-h" || args[i] == "--help") {
            options.help = true;
            return options;
        } else if (args[i][0] == '-') {
            throw UsageError("unknown option " + args[i]);
        } else {
            words.push_back(args[i]);
        }
    }
    const std::size_t expected = !words.empty() && words[0] == "bad" ? 2 : 1;
    if (words.size() != expected) throw UsageError("expected one SHAPE, or bad and one KIND");
    (expected == 2 ? options.badKind : options.shape) = words.back();
    if (options.output.empty()) throw UsageError("-o FILE.vdb is missing");
    if (!(options.voxelSize > 0)) throw UsageError("--voxel-size must be above 0");
    if (!(options.halfWidth >= 1)) throw UsageError("--half-width must be at least 1 voxel");
    return options;
}

openvdb::GridClass parseGridClass(const std::string& text) {
    if (text == "level-set") return openvdb::GRID_LEVEL_SET;
    if (text == "fog") return openvdb::GRID_FOG_VOLUME;
    if (text == "unknown") return openvdb::GRID_UNKNOWN;
    throw UsageError("--grid-class " + text + ": expected level-set, fog or unknown");
}

openvdb::GridBase::Ptr makeGrid(Options& options) {
    const auto entry = findIn(shapeTable(), options.shape, &ShapeEntry::name);
    const Shape shape = entry->make(options.parameters);
    options.parameters.requireAllKnown();
    auto transform = openvdb::math::Transform::createLinearTransform(options.voxelSize);
    if (options.angle != 0)
        transform =
            rotatedTransform(options.voxelSize, options.axis, options.angle, options.translation);
    else
        transform->postTranslate(options.translation);
    openvdb::GridBase::Ptr grid;
    if (options.asDouble)
        grid = makeDoubleLevelSet(shape, *transform, options.halfWidth, options.name);
    else
        grid = makeLevelSet(shape, *transform, options.halfWidth, options.name);
    grid->setGridClass(parseGridClass(options.gridClass));
    grid->setSaveFloatAsHalf(options.asHalf);
    return grid;
}

void run(Options& options) {
    openvdb::GridCPtrVec grids;
    if (options.badKind.empty()) {
        grids.push_back(makeGrid(options));
    } else {
        const auto made = findIn(badInputs(), options.badKind, &BadInput::kind)->make();
        grids.assign(made.begin(), made.end());
    }
    writeVdb(options.output, grids);
}

}  // namespace

int main(int argc, char** argv) {
    try {
        Options options = parse({argv + 1, argv + argc});
        if (options.help) {
            std::cout << usage();
            return 0;
        }
        openvdb::initialize();
        run(options);
        return 0;
    } catch (const UsageError& error) {
        std::cerr << "make_shape: error: " << error.what() << "\n\n" << usage();
        return 2;
    } catch (const std::exception& error) {
        std::cerr << "make_shape: error: " << error.what() << "\n";
        return 1;
    }
}
