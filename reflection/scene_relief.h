#pragma once
// What a picture's relief is traced with: made once, for the triangles where the camera can see it. Private to
// reflection.
#include "common/services/progress.h"
#include "common/services/work_report.h"
#include "reflection/camera_rays.h"
#include "reflection/relief/exact_tracer.h"
#include "reflection/relief/relief_openness.h"
#include "reflection/relief/surface_relief.h"

#include <memory>
#include <vector>

namespace kokage {

/// One height map at one steepness.
struct ReliefMap {
    std::unique_ptr<ExactTracer> tracer;
    ReliefOpenness openness; ///< about the relief's own normals
};

struct SceneRelief {
    static constexpr std::uint32_t kNone = 0xffffffffu;

    ReliefShell shell; ///< layer 0 is solid; layer k + 1 has maps[k]
    TangentFrames frames;
    std::vector<ReliefMap> maps;
    std::vector<std::uint32_t> scene_triangle; ///< of each prism
    std::vector<std::uint32_t> prism;          ///< of each of the scene's triangles, or kNone
    std::unique_ptr<SurfaceRelief> surface;

    std::size_t bytes() const;
};

/// Relief of triangles of which `frame` may see a quarter of a pixel of depth, with those of other bark that adjoin
/// them, as solid. Null where there are none; the report tells why, or what was made. `skip_thin` false: of all
/// triangles in view. Throws InputError where a look's relief can't be traced.
std::unique_ptr<SceneRelief> make_scene_relief(const ShadedScene& scene, const CameraFrame& frame, bool skip_thin,
                                               Progress& progress, WorkReport& report);

} // namespace kokage
