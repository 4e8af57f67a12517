#include "trees/extras_reader.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <tiny_gltf.h>

namespace kokage {

const nlohmann::json& ExtrasReader::member(const nlohmann::json& object, const char* name) {
    static const nlohmann::json none;
    if (object.is_object())
        if (const auto found = object.find(name); found != object.end())
            return *found;
    good = false;
    return none;
}

const nlohmann::json& ExtrasReader::list(const nlohmann::json& object, const char* name) {
    static const nlohmann::json none = nlohmann::json::array();
    const auto found = object.is_object() ? object.find(name) : object.end();
    if (!object.is_object() || found == object.end() || found->is_null())
        return none;
    good = good && found->is_array();
    return found->is_array() ? *found : none;
}

std::uint64_t ExtrasReader::count(const nlohmann::json& object, const char* name) {
    const nlohmann::json& value = member(object, name);
    good = good && value.is_number_unsigned();
    return good ? value.get<std::uint64_t>() : 0;
}

bool ExtrasReader::flag(const nlohmann::json& object, const char* name) {
    const nlohmann::json& value = member(object, name);
    good = good && value.is_boolean();
    return good && value.get<bool>();
}

float ExtrasReader::number(const nlohmann::json& object, const char* name) {
    const nlohmann::json& value = member(object, name);
    good = good && value.is_number() && std::isfinite(value.get<float>());
    return good ? value.get<float>() : 0.f;
}

std::string ExtrasReader::text(const nlohmann::json& object, const char* name) {
    const nlohmann::json& value = member(object, name);
    good = good && value.is_string();
    return good ? value.get<std::string>() : "";
}

std::vector<std::uint32_t> ExtrasReader::integers(const nlohmann::json& object, const char* name,
                                                  std::uint64_t wanted) {
    const int accessor = index(object, name, wanted, TINYGLTF_TYPE_SCALAR, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT);
    return accessor < 0 ? std::vector<std::uint32_t>() : document_.unsigned_integers(accessor);
}

std::vector<float> ExtrasReader::floats(const nlohmann::json& object, const char* name, std::uint64_t wanted) {
    const int accessor = index(object, name, wanted, TINYGLTF_TYPE_SCALAR, TINYGLTF_COMPONENT_TYPE_FLOAT);
    return accessor < 0 ? std::vector<float>() : document_.floats(accessor, 1);
}

template <typename Vector>
std::vector<Vector> ExtrasReader::vectors(const nlohmann::json& object, const char* name, std::uint64_t wanted) {
    constexpr int components = int(Vector::length());
    const int type = components == 3 ? TINYGLTF_TYPE_VEC3 : TINYGLTF_TYPE_VEC4;
    const int accessor = index(object, name, wanted, type, TINYGLTF_COMPONENT_TYPE_FLOAT);
    if (accessor < 0)
        return {};
    const std::vector<float> values = document_.floats(accessor, components);
    std::vector<Vector> result(wanted);
    for (std::size_t i = 0; i < result.size(); ++i)
        for (std::size_t c = 0; c < std::size_t(components); ++c)
            result[i][c] = values[i * std::size_t(components) + c];
    return result;
}

template std::vector<glm::vec3> ExtrasReader::vectors(const nlohmann::json&, const char*, std::uint64_t);
template std::vector<glm::vec4> ExtrasReader::vectors(const nlohmann::json&, const char*, std::uint64_t);

/// The accessor that a member names, if it is as long and of the type that is wanted; -1 if not, or if nothing is
/// wanted.
int ExtrasReader::index(const nlohmann::json& object, const char* name, std::uint64_t wanted, int type, int component) {
    if (wanted == 0)
        return -1;
    const nlohmann::json& value = member(object, name);
    good = good && value.is_number_unsigned() && value.get<std::uint64_t>() < document_.model().accessors.size();
    if (!good)
        return -1;
    const auto accessor = value.get<std::size_t>();
    const tinygltf::Accessor& found = document_.model().accessors[accessor];
    good = found.count == wanted && found.type == type && found.componentType == component;
    return good ? int(accessor) : -1;
}

} // namespace kokage
