/// Conversions between NumPy's arrays and the library's vectors.
#pragma once

#include <igeo/igeo.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace py = pybind11;

template <typename T>
using Array = py::array_t<T, py::array::c_style>;

static_assert(sizeof(igeo::Vec3d) == 3 * sizeof(double) &&
              sizeof(igeo::Vec3f) == 3 * sizeof(float));

/// An array that owns the vector, without a copy.
template <typename T, typename Element>
Array<T> owning(std::vector<Element>&& values, std::vector<py::ssize_t> shape) {
    auto kept = std::make_unique<std::vector<Element>>(std::move(values));
    const T* data = reinterpret_cast<const T*>(kept->data());
    const py::capsule owner(kept.get(),
                            [](void* p) { delete static_cast<std::vector<Element>*>(p); });
    kept.release();
    return Array<T>(std::move(shape), data, owner);
}

template <typename T>
Array<T> arrayOf(std::vector<T>&& values) {
    const auto n = py::ssize_t(values.size());
    return owning<T>(std::move(values), {n});
}

/// Shape (n, 3).
template <typename T>
Array<T> arrayOf(std::vector<igeo::Vec3<T>>&& points) {
    const auto n = py::ssize_t(points.size());
    return owning<T>(std::move(points), {n, 3});
}

inline Array<std::uint32_t> arrayOf(std::vector<igeo::TriangleMesh::Triangle>&& triangles) {
    const auto n = py::ssize_t(triangles.size());
    return owning<std::uint32_t>(std::move(triangles), {n, 3});
}

/// Sources in NumPy's convention: -1 for none.
inline Array<std::int32_t> labelsOf(const std::vector<std::uint32_t>& labels) {
    std::vector<std::int32_t> numbers(labels.size());
    for (std::size_t k = 0; k < labels.size(); ++k)
        numbers[k] = labels[k] == igeo::kNoLabel ? -1 : std::int32_t(labels[k]);
    return arrayOf(std::move(numbers));
}

template <typename T>
std::vector<T> vectorOf(const Array<T>& array) {
    return std::vector<T>(array.data(), array.data() + array.size());
}

/// From shape (n, 3); one copy.
inline std::vector<igeo::Vec3d> pointsOf(const Array<double>& array) {
    std::vector<igeo::Vec3d> points(std::size_t(array.size() / 3));
    if (!points.empty())
        std::memcpy(points.data(), array.data(), points.size() * sizeof(points[0]));
    return points;
}

inline igeo::Vec3d pointOf(const Array<double>& array) {
    return {array.at(0), array.at(1), array.at(2)};
}
