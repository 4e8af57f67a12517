#include "viewer/scene/render_scene.h"
#include "common/services/count_text.h"
#include "foliage/method.h"
#include "foliage/patch_light_maps.h"
#include "reflection/gloss_in_transport.h"
#include "reflection/light_map_readers.h"
#include "reflection/path_traced_picture.h"
#include "reflection/picture_memory.h"
#include "viewer/scene/scene_memory.h"
#include "viewer/scene/stage_clock.h"

namespace kokage {
namespace {

/// Per patch: 1 where it is to read light maps. Of trees alone: an object stands anywhere.
std::vector<std::uint8_t> patches_to_read_maps(const AssembledScene& scene, const RenderOptions& options,
                                               const ShadedScene& shaded) {
    if (!options.light_maps)
        return {};
    std::vector<std::uint8_t> readers = light_map_readers(shaded, scene.environment, scene.camera, options.picture);
    for (std::size_t t = 0; t < scene.patches.triangles.size(); ++t)
        if (scene.origins.triangle_part[t] >= scene.tree_parts)
            readers[scene.patches.triangle_patch[t]] = 0;
    if (!options.skip_unread_light_maps)
        std::fill(readers.begin(), readers.end(), 1);
    return readers;
}

LightMapsOfPatches light_maps_for(const std::vector<std::uint8_t>& readers, const AssembledScene& scene,
                                  const PatchLightMapOptions& options, const RayQueries& queries,
                                  const SideRadiance& radiance, WorkReport& report, Progress& progress) {
    LightMapsOfPatches maps =
        make_patch_light_maps(queries, scene.tree, readers, scene.environment, radiance, options, progress, report);
    if (maps.empty())
        report.skips.push_back({"light maps", "no rough, glossy bark in view reads any", "their rays and memory"});
    return maps;
}

/// The fast way: light is solved once for all patches, pixels read it.
Picture render_solved(const AssembledScene& scene, const RenderOptions& options, StageClock& clock, WorkReport& report,
                      Progress& progress) {
    ShadedScene shaded = unlit_scene(scene);
    const std::vector<std::uint8_t> map_readers = patches_to_read_maps(scene, options, shaded);
    const PatchLightMapOptions map_options{.seed = options.picture.seed};
    check_memory(estimated_transport_bytes(double(scene.patches.patches.size()), options.error) +
                     estimated_picture_bytes(options.picture, scene.patches) +
                     light_map_bytes(scene.patches, map_readers, map_options.bands),
                 "the light of " + count_text(scene.patches.patches.size()) +
                     " patches at this error, with the picture,",
                 "ask for a larger error, fewer trees, fewer leaves, or a smaller picture");
    ShadingOptions shading;
    shading.error = options.error;
    shading.merge_weak_lights = options.merge_weak_lights;
    shading.check_by_paths = gather_rays_of(options.picture) == 0 || !options.skip_check_by_paths;
    const std::unique_ptr<Transport> transport =
        clock.run("transport", [&] { return make_transport(scene.patches, scene.tree, shading, progress); });
    progress.throw_if_stopped();
    std::vector<Optics> with_gloss;
    clock.run("gloss", [&] {
        with_gloss = optics_with_gloss(shaded);
        transport->set_optics(with_gloss);
    });
    Solution solution = clock.run("solve", [&] { return transport->solve(scene.environment, progress); });
    report.counts.insert(report.counts.end(), solution.report.counts.begin(), solution.report.counts.end());
    report.skips.insert(report.skips.end(), solution.report.skips.begin(), solution.report.skips.end());
    report.warnings.insert(report.warnings.end(), solution.report.warnings.begin(), solution.report.warnings.end());
    if (solution.energy_in == 0 && !scene.patches.patches.empty())
        report.warnings.push_back("no light reaches the scene, or all of it is black");
    progress.throw_if_stopped();
    const auto queries = clock.run("ray structure", [&] { return std::make_unique<const RayQueries>(scene.patches); });
    if (options.light_maps)
        shaded.light_maps = clock.run("light maps", [&] {
            return light_maps_for(map_readers, scene, map_options, *queries, solution.radiance, report, progress);
        });
    return clock.run("render", [&] {
        shaded.indirect_front = std::move(solution.indirect.front);
        shaded.indirect_back = std::move(solution.indirect.back);
        shaded.radiance_front = std::move(solution.radiance.front);
        shaded.radiance_back = std::move(solution.radiance.back);
        take_gloss_out(with_gloss, shaded);
        return render_picture(shaded, *queries, scene.environment, scene.camera, options.picture, progress);
    });
}

Picture render_paths(const AssembledScene& scene, const RenderOptions& options, StageClock& clock, Progress& progress) {
    return clock.run("trace", [&] {
        const ShadedScene shaded = unlit_scene(scene);
        const RayQueries queries(scene.patches);
        return render_path_traced(shaded, queries, scene.environment, scene.camera, options.picture, progress);
    });
}

} // namespace

RenderedScene render_scene(const AssembledScene& scene, const RenderOptions& options, Progress& progress) {
    RenderedScene rendered;
    StageClock clock;
    rendered.picture = options.method == RenderMethod::fast
                           ? render_solved(scene, options, clock, rendered.report, progress)
                           : render_paths(scene, options, clock, progress);
    rendered.report.stages = clock.stages();
    WorkReport of_picture = rendered.picture.report;
    of_picture.stages.clear(); // they are parts of "render"
    rendered.report.append(of_picture);
    return rendered;
}

} // namespace kokage
