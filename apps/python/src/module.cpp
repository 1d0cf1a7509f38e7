#include <igeo/base/atomic_file.h>
#include <igeo/base/error.h>
#include <igeo/base/parallel.h>
#include <igeo/base/version.h>

#include <exception>

#include "arrays.h"
#include "bindings.h"

namespace {

/// Raises the package's exception for an error of the library.
void raise(const igeo::Error& error) {
    const py::object made = py::module_::import("igeo._errors")
                                .attr("error_for")(int(error.kind()), error.what(), error.remedy());
    PyErr_SetObject(py::type::handle_of(made).ptr(), made.ptr());
}

void translate(std::exception_ptr thrown) {
    try {
        if (thrown) std::rethrow_exception(thrown);
    } catch (const igeo::Error& error) {
        try {
            raise(error);
        } catch (py::error_already_set& other) {
            other.restore();
        }
    }
}

}  // namespace

PYBIND11_MODULE(_igeo, module) {
    openvdb::initialize();
    py::register_exception_translator(&translate);
    module.doc() = "What the package igeo is made of; its arguments are not checked.";
    module.attr("__version__") = igeo::kVersion;
    module.attr("color_maps") = igeo::ColorMap::names();
    module.attr("farthest_index") = igeo::kFarthestIndex;
    py::class_<igeo::ThreadLimit>(module, "ThreadLimit")
        .def(py::init<int>(), py::arg("threads"))
        .def_static("current", &igeo::ThreadLimit::current);
    module.def("write_file", [](const std::string& file, const py::bytes& bytes) {
        igeo::writeFile(file, std::string(bytes));
    });
    bindSurface(module);
    bindMetric(module);
    bindSolver(module);
    bindDistance(module);
}
