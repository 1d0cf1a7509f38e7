#include "option_words.h"

#include <utility>

std::string inOptionWords(std::string text) {
    // Longer names come before their prefixes.
    static constexpr std::pair<const char*, const char*> kWords[] = {
        {"the iso of rebuilt()", "--iso"},
        {"the iso of volumeMesh()", "--iso"},
        {"rebuilt(psi, D)", "--rebuild --iso D"},
        {"rebuilt()", "--rebuild"},
        {"readPointCloud", "--points"},
        {"readLevelSetGrid", "--sdf"},
        {"TriangleMesh", "--mesh"},
        {"Scheme::Jet", "--scheme jet"},
        {"Space::Index", "add --space index"},
        {"Space::World", "leave out --space index"},
        {"SolverOptions::band", "--band"},
        {"MetricDefinition::obstacles", "--obstacle"},
        {"maxDistance", "--max-distance"},
        {"memoryLimit", "--memory-limit"},
        {"joinGaps", "--join-gaps"},
        {"maxSnap", "--snap"},
        {"isSigned", "--signed"}};
    for (const auto& [name, option] : kWords)
        for (auto at = text.find(name); at != std::string::npos; at = text.find(name))
            text.replace(at, std::string(name).size(), option);
    return text;
}
