#include "reflection/maps/make_baker.h"
#include "common/services/error.h"
#include "reflection/maps/brute_force_baker.h"
#include "reflection/maps/spectral_baker.h"
#include "reflection/maps/table_baker.h"

#include <algorithm>
#include <string>

namespace kokage {

namespace {
constexpr BakeMethod kMethods[] = {BakeMethod::spectral, BakeMethod::table, BakeMethod::brute_force};

class SameEverywhereBaker final : public Baker {
    void bake(const Environment& surroundings, std::span<glm::vec3> filtered, WorkReport& report, Progress&) override {
        const float* color = surroundings.remainder.at(0, 0);
        std::fill(filtered.begin(), filtered.end(), glm::vec3(color[0], color[1], color[2]));
        report.counts.push_back({"texels", filtered.size()});
    }
};

} // namespace

std::string_view bake_method_name(BakeMethod method) {
    switch (method) {
    case BakeMethod::spectral:
        return "spectral";
    case BakeMethod::table:
        return "table";
    case BakeMethod::brute_force:
        return "brute-force";
    }
    return "";
}

BakeMethod bake_method_from_name(std::string_view name) {
    std::string known;
    for (const BakeMethod method : kMethods) {
        if (bake_method_name(method) == name)
            return method;
        known += (known.empty() ? "" : ", ") + std::string(bake_method_name(method));
    }
    throw InputError("there is no way to bake called '" + std::string(name) + "'; there are: " + known);
}

std::unique_ptr<Baker> make_baker(const TexelLayout& layout, int image_width, int image_height,
                                  const BakerSettings& settings, WorkReport& report, Progress& progress) {
    switch (settings.method) {
    case BakeMethod::table:
        return table_baker(layout, {.table = settings.table, .stored_table = settings.stored_setup}, report, progress);
    case BakeMethod::brute_force:
        return brute_force_baker(layout, image_width, image_height);
    case BakeMethod::spectral:
        break;
    }
    return spectral_baker(layout, image_width, image_height,
                          {.tolerance = settings.tolerance, .stored_setup = settings.stored_setup}, report, progress);
}

bool is_same_everywhere(const Environment& surroundings) {
    const Image& image = surroundings.remainder;
    if (!surroundings.distant_lights.empty())
        return false;
    for (std::size_t i = 0; i < image.pixels.size(); i += std::size_t(image.channels))
        if (!std::equal(image.pixels.begin(), image.pixels.begin() + 3, image.pixels.begin() + std::ptrdiff_t(i)))
            return false;
    return true;
}

std::unique_ptr<Baker> same_everywhere_baker(WorkReport& report) {
    report.skips.push_back({"all filtering", "the surroundings are the same everywhere", "the whole bake"});
    return std::make_unique<SameEverywhereBaker>();
}

} // namespace kokage
