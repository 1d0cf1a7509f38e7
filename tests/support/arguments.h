/// Arguments of bench and test programs: --name value, in any order.
#pragma once

#include <igeo/base/types.h>

#include <algorithm>
#include <cstdio>
#include <initializer_list>
#include <map>
#include <stdexcept>
#include <string>

namespace igeo::test {

struct Arguments {
    std::map<std::string, std::string> values;

    /// @param first  the first word that may be a name
    Arguments(int argc, char** argv, int first) {
        for (int k = first; k < argc; k += 2) {
            const std::string name = argv[k];
            if (name.rfind("--", 0) != 0 || k + 1 == argc)
                throw std::runtime_error("expected --name value at '" + name + "'");
            values[name.substr(2)] = argv[k + 1];
        }
    }
    /// Refuses names other than these.
    void require(std::initializer_list<const char*> known) const {
        for (const auto& [name, value] : values)
            if (std::find(known.begin(), known.end(), name) == known.end())
                throw std::runtime_error("unknown option --" + name);
    }
    bool has(const std::string& name) const { return values.count(name) > 0; }
    double number(const std::string& name, double otherwise) const {
        return has(name) ? std::stod(values.at(name)) : otherwise;
    }
    std::string text(const std::string& name, const std::string& otherwise) const {
        return has(name) ? values.at(name) : otherwise;
    }
    std::string text(const std::string& name) const {
        if (!has(name)) throw std::runtime_error("--" + name + " is missing");
        return values.at(name);
    }
    /// x,y,z
    Vec3d point(const std::string& name) const {
        Vec3d p;
        if (std::sscanf(text(name).c_str(), "%lf,%lf,%lf", &p.x, &p.y, &p.z) != 3)
            throw std::runtime_error("--" + name + " " + text(name) + " is not x,y,z");
        return p;
    }
};

}  // namespace igeo::test
