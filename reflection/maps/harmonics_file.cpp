#include "reflection/maps/harmonics_file.h"

#include "common/directions/spherical_harmonics.h"
#include "common/services/error.h"
#include "common/services/named_file.h"
#include "common/services/output_file.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace kokage {
namespace {

using Json = nlohmann::json;
using OrderedJson = nlohmann::ordered_json;

constexpr const char* kKind = "spherical harmonics";
constexpr const char* kConvention =
    "real orthonormal, index l(l+1)+m, no Condon-Shortley phase, +Y up, Y_1,-1..1 ~ y, z, x";
constexpr int kVersion = 2;
constexpr std::uint64_t kMostBytes = std::uint64_t(1) << 28;

const char* unit_of(HarmonicQuantity quantity) {
    return quantity == HarmonicQuantity::radiance ? "of the image" : "of the image x sr";
}

OrderedJson triple(const glm::vec3& v, const std::filesystem::path& path, const std::string& what) {
    if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z))
        throw InputError("cannot write '" + path.string() + "': " + what + " is not finite");
    return {v.x, v.y, v.z};
}

class Reader {
  public:
    Reader(const std::filesystem::path& path) : name_(path.string()) {}
    [[noreturn]] void fail(const std::string& why) const {
        throw InputError("cannot read harmonics '" + name_ + "': " + why);
    }
    /// Null where there is none.
    static const Json& member(const Json& object, const char* key) {
        static const Json none;
        const auto found = object.find(key);
        return found == object.end() ? none : *found;
    }
    float number(const Json& value, const std::string& what) const {
        if (value.is_number())
            if (const float result = value.get<float>(); std::isfinite(result))
                return result;
        fail(what + " is no number that a float holds");
    }
    glm::vec3 triple(const Json& value, const std::string& what) const {
        if (!value.is_array() || value.size() != 3)
            fail(what + " is not three numbers");
        return {number(value[0], what), number(value[1], what), number(value[2], what)};
    }
    HarmonicQuantity quantity(const Json& value) const {
        for (const HarmonicQuantity one : {HarmonicQuantity::radiance, HarmonicQuantity::irradiance})
            if (value == harmonic_quantity_name(one))
                return one;
        fail("its quantity is neither radiance nor irradiance");
    }
    Harmonics::Light light(const Json& value) const {
        if (!value.is_object() || !member(value, "name").is_string())
            fail("it lists a light that has no name");
        Harmonics::Light light;
        light.name = member(value, "name").get<std::string>();
        light.direction = triple(member(value, "direction"), "the direction of a light");
        light.irradiance = triple(member(value, "irradiance"), "the irradiance of a light");
        light.half_angle = number(member(value, "half_angle"), "the half angle of a light");
        if (std::abs(glm::length(light.direction) - 1) > 1e-3f || !(light.half_angle >= 0 && light.half_angle < 4))
            fail("a light's direction is no unit vector, or its half angle none from 0 to pi");
        return light;
    }

  private:
    std::string name_;
};

} // namespace

void write_harmonics(const std::filesystem::path& path, const Harmonics& harmonics, const std::string& made_from) {
    OrderedJson list = OrderedJson::array(), lights = OrderedJson::array();
    for (const glm::vec3& c : harmonics.coefficients)
        list.push_back(triple(c, path, "coefficient " + std::to_string(list.size())));
    for (const Harmonics::Light& light : harmonics.lights)
        lights.push_back({{"name", light.name},
                          {"direction", triple(light.direction, path, "a light's direction")},
                          {"half_angle", light.half_angle},
                          {"irradiance", triple(light.irradiance, path, "a light's irradiance")}});
    const OrderedJson json = {{"kind", kKind},
                              {"version", kVersion},
                              {"convention", kConvention},
                              {"quantity", harmonic_quantity_name(harmonics.quantity)},
                              {"unit", unit_of(harmonics.quantity)},
                              {"bands", harmonics.bands()},
                              {"made_from", made_from},
                              {"coefficients", list},
                              {"lights", lights}};
    write_file(path, json.dump(1, ' ', false, OrderedJson::error_handler_t::replace) + "\n");
}

HarmonicsFile read_harmonics(const std::filesystem::path& path) {
    const Reader reader(path);
    const std::vector<unsigned char> bytes = read_file_bytes(path, kMostBytes);
    const Json json = Json::parse(bytes, nullptr, false);
    if (!json.is_object() || Reader::member(json, "kind") != kKind)
        reader.fail("it is no whole JSON file of spherical harmonics");
    if (Reader::member(json, "version") != kVersion || Reader::member(json, "convention") != kConvention)
        reader.fail("it is of another version or convention than this program's; export it again");
    HarmonicsFile file;
    file.harmonics.quantity = reader.quantity(Reader::member(json, "quantity"));
    const Json &bands = Reader::member(json, "bands"), &list = Reader::member(json, "coefficients"),
               &lights = Reader::member(json, "lights"), &made_from = Reader::member(json, "made_from");
    if (!bands.is_number_integer() || bands < 1 || bands > HarmonicsSettings::most_bands || !list.is_array() ||
        list.size() != sh_count(bands.get<int>()))
        reader.fail("its coefficients are not as many as its bands say");
    for (const Json& value : list)
        file.harmonics.coefficients.push_back(
            reader.triple(value, "coefficient " + std::to_string(file.harmonics.coefficients.size())));
    if (!lights.is_array())
        reader.fail("its list of lights is missing");
    for (const Json& light : lights)
        file.harmonics.lights.push_back(reader.light(light));
    if (made_from.is_string())
        file.made_from = made_from.get<std::string>();
    return file;
}

} // namespace kokage
