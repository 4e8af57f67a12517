#include "foliage/patch_light_maps.h"
#include "common/services/count_text.h"
#include "foliage/capture_directions.h"
#include "foliage/ground_light.h"
#include "foliage/light_map_field.h"

#include <algorithm>

namespace kokage {
namespace {

int stems_of(const Tree& tree) {
    return int(std::count_if(tree.skeleton.branches.begin(), tree.skeleton.branches.end(),
                             [](const Branch& branch) { return branch.parent < 0; }));
}

} // namespace

LightMapsOfPatches make_patch_light_maps(const RayQueries& queries, const Tree& tree,
                                         const std::vector<std::uint8_t>& readers, const Environment& environment,
                                         const SideRadiance& radiance, const PatchLightMapOptions& options,
                                         Progress& progress, WorkReport& report) {
    if (std::find(readers.begin(), readers.end(), 1) == readers.end())
        return {};
    GroundLight ground(queries, options.seed, progress);
    ground.set_environment(environment, progress);
    LightMapFieldOptions field_options;
    field_options.maps = options.maps_a_stem * std::max(1, stems_of(tree));
    field_options.bands = options.bands;
    field_options.readers = readers;
    LightMapField field(queries, ground.grid(), tree, field_options, progress);
    field.update(radiance, ground.radiance(radiance));
    const std::size_t captured = field.maps().places().size();
    report.counts.push_back({"light maps", captured});
    if (field.unread_maps() > 0)
        report.skips.push_back(
            {"light maps elsewhere", "nothing in view reads them",
             count_text(field.unread_maps()) + " of " + count_text(captured + field.unread_maps()) + " maps"});
    return field.export_for_patches(cell_means(field.maps().directions(), environment.remainder));
}

} // namespace kokage
