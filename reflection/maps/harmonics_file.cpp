#include "reflection/maps/harmonics_file.h"

#include "common/directions/spherical_harmonics.h"
#include "common/services/error.h"
#include "common/services/named_file.h"
#include "common/services/output_file.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace kokage {
namespace {

constexpr const char* kKind = "spherical harmonics";
constexpr const char* kConvention =
    "real orthonormal, index l(l+1)+m, no Condon-Shortley phase, +Y up, Y_1,-1..1 ~ y, z, x";
constexpr int kVersion = 1, kMostBands = 512;

} // namespace

void write_harmonics(const std::filesystem::path& path, std::span<const glm::vec3> coefficients,
                     const std::string& made_from) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const glm::vec3& c : coefficients) {
        if (!std::isfinite(c.r) || !std::isfinite(c.g) || !std::isfinite(c.b))
            throw InputError("cannot write '" + path.string() + "': coefficient " + std::to_string(list.size()) +
                             " is not finite");
        list.push_back({c.r, c.g, c.b});
    }
    const nlohmann::ordered_json json = {{"kind", kKind},
                                         {"version", kVersion},
                                         {"convention", kConvention},
                                         {"quantity", "radiance"},
                                         {"bands", sh_bands(coefficients.size())},
                                         {"made_from", made_from},
                                         {"coefficients", list}};
    write_file(path, json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
}

std::vector<glm::vec3> read_harmonics(const std::filesystem::path& path) {
    const auto fail = [&](const std::string& why) -> void {
        throw InputError("cannot read harmonics '" + path.string() + "': " + why);
    };
    const std::vector<unsigned char> bytes = read_file_bytes(path, std::uint64_t(1) << 28);
    const nlohmann::json json = nlohmann::json::parse(bytes, nullptr, false);
    if (!json.is_object() || json.value("kind", nlohmann::json()) != kKind)
        fail("it is no whole JSON file of spherical harmonics");
    if (json.value("version", nlohmann::json()) != kVersion ||
        json.value("convention", nlohmann::json()) != kConvention)
        fail("it is of another version or convention than this program's; export it again");
    const nlohmann::json bands = json.value("bands", nlohmann::json()),
                         list = json.value("coefficients", nlohmann::json());
    if (!bands.is_number_integer() || bands < 1 || bands > kMostBands || !list.is_array() ||
        list.size() != sh_count(bands.get<int>()))
        fail("its coefficients are not as many as its bands say");
    std::vector<glm::vec3> coefficients;
    for (const nlohmann::json& value : list) {
        if (!value.is_array() || value.size() != 3 || !value[0].is_number() || !value[1].is_number() ||
            !value[2].is_number())
            fail("coefficient " + std::to_string(coefficients.size()) + " is not three numbers");
        coefficients.emplace_back(value[0].get<float>(), value[1].get<float>(), value[2].get<float>());
    }
    return coefficients;
}

} // namespace kokage
