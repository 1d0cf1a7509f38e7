#include <igeo/base/error.h>
#include <igeo/base/version.h>

#include <iostream>

int main() {
    try {
        throw igeo::Error(igeo::Error::Kind::BadInput, "an error to catch");
    } catch (const igeo::Error& error) {
        if (error.kind() != igeo::Error::Kind::BadInput) return 1;
    }
    std::cout << igeo::kVersion << '\n';
}
