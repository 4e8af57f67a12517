#pragma once
// Extensions' members as tinygltf keeps them, for files that may hold anything. Private to common/gltf.
#include <string>
#include <tiny_gltf.h>

namespace kokage {

/// A member of an object; null if it is not there, or `value` is no object (which tinygltf would not survive).
inline const tinygltf::Value& member(const tinygltf::Value& value, const std::string& name) {
    static const tinygltf::Value none;
    return value.IsObject() && value.Has(name) ? value.Get(name) : none;
}

} // namespace kokage
