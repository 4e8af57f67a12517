#include "reflection/maps/make_baker.h"
#include "common/services/error.h"
#include "reflection/maps/brute_force_baker.h"
#include "reflection/maps/spectral_baker.h"
#include "reflection/maps/table_baker.h"

#include <string>

namespace kokage {

namespace {
constexpr BakeMethod kMethods[] = {BakeMethod::spectral, BakeMethod::table, BakeMethod::brute_force};
}

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

} // namespace kokage
