#pragma once
// A cube map whose mip levels hold light filtered by ever wider lobes: what engines take (KTX2, DDS).
//
// Faces in the order +X, -X, +Y, -Y, +Z, -Z, each n x n texels, rows from the top, as OpenGL (ES 3.2, table 8.20), KTX
// 2 and Direct3D keep them: textureLod(cube, direction, level) gives the light that arrives FROM `direction`, in the
// house's own frame (common/types.h), nothing mirrored. Each face below shows what its texel (x, y) looks at, with
// s = 2 (x + 1/2) / n - 1 to the right and t = 2 (y + 1/2) / n - 1 downwards:
//
//                +---------+
//                | +Y      |           +X ( 1, -t, -s)    -X (-1, -t,  s)
//                | (s,1,t) |           +Y ( s,  1,  t)    -Y ( s, -1, -t)
//      +---------+---------+---------+---------+
//      | -X      | +Z      | +X      | -Z      |    +Z ( s, -t,  1)    -Z (-s, -t, -1)
//      |         |         |         |         |
//      +---------+---------+---------+---------+    In this unfolding, edges that touch here touch on the cube.
//                | -Y      |           Seen from inside, with +Y up, each face appears mirrored left to right:
//                |         |           cube maps count in a left-handed frame, and we look up right-handed directions.
//                +---------+
//
// Hosts that mirror x on their own (three.js does for CubeTexture) have to be told not to, or to look up (-x, y, z).
#include "common/environment/environment.h"
#include "common/services/progress.h"
#include "common/services/work_report.h"
#include "reflection/maps/baker.h"
#include "reflection/maps/texel_layout.h"

#include <span>
#include <vector>

namespace kokage {

/// Level 0 is `size` wide, each further level half as wide. Every level has a lobe of its own, or none.
struct PrefilteredCube {
    struct Level {
        int size = 0;
        /// Lobe::parameter: glTF's roughness, or Phong's exponent.
        double parameter = 0;
        /// True: the image itself, averaged over each texel (roughness 0).
        bool unfiltered = false;
        std::vector<glm::vec3> texels; ///< 6 size², face by face, rows from the top
    };
    LobeKind kind = LobeKind::ggx;
    std::vector<Level> levels;
};

/// Unit direction of a texel's centre.
glm::dvec3 cube_texel_direction(int face, int x, int y, int size);
/// Exact solid angle of a texel, sr; the same on every face.
double cube_texel_solid_angle(int x, int y, int size);
/// Of all texels of a face, rows from the top: the same, in a tenth of the time.
std::vector<double> cube_texel_solid_angles(int size);

/// What a cube is to hold. Level i has parameters[i]; GGX's roughness 0, and an infinite exponent of Phong's, are the
/// image itself, which only the first level may be.
struct CubeSettings {
    int size = 256; ///< of level 0, 1 ... 16384; with several levels a power of two
    LobeKind kind = LobeKind::ggx;
    std::vector<double> parameters;
};

/// Whether that is the image itself: GGX's roughness 0, an infinite exponent of Phong's.
bool is_unfiltered(LobeKind kind, double parameter);
/// Throws InputError for settings that make no cube.
void check_cube(const CubeSettings& settings);
/// Levels from `size` down to 16, and at least five, as far as sizes can be halved: 512 has 6, 64 and 16 have 5, 8 has
/// 4, 7 has 1.
int usual_level_count(int size);
/// Level i of n has roughness i / (n-1): glTF's EXT_lights_image_based, "levels evenly map to roughness 0 to 1".
std::vector<double> even_roughness(int levels);
/// As Filament and its cmgen lay them out: with a = i / (n-1), roughness 1 - sqrt(1 - a); finer steps where it is
/// smooth. (tools/cmgen/src/cmgen.cpp, lodToPerceptualRoughness: the root of 2 r - r² = a.)
std::vector<double> filament_roughness(int levels);

/// A cube with all its levels, their texels black. Throws InputError as check_cube() does.
PrefilteredCube empty_cube(const CubeSettings& settings);
/// The texels of the filtered levels, in order: what a baker is made for.
TexelLayout filtered_layout(const PrefilteredCube& cube);
/// Texels a baker gave back, in that layout's order.
void set_filtered_texels(PrefilteredCube& cube, std::span<const glm::vec3> filtered);
/// Fills all levels: the unfiltered one straight from the lat-long image (cube_area_filter.h), the others by `baker`,
/// which was made for filtered_layout(cube); it may be null where there are none. Surroundings as Baker::bake takes
/// them.
void bake_cube(PrefilteredCube& cube, const Environment& surroundings, Baker* baker, WorkReport& report,
               Progress& progress = silent_progress());

/// One level in a direction (any length but 0), bilinear and across the cube's edges, as GL's seamless cube maps
/// filter: at a face's corner, where only three texels meet, their mean stands for the fourth.
glm::vec3 cube_lookup(const PrefilteredCube::Level& level, const glm::dvec3& direction);
/// Between levels `lod` and the next, linearly, as textureLod does.
glm::vec3 cube_lookup(const PrefilteredCube& cube, const glm::dvec3& direction, double lod);

/// Index in Level::texels of the texel that a direction (any length but 0) meets.
std::size_t cube_texel_towards(const glm::dvec3& direction, int size);
/// Index in Level::texels of the texel beside one of a face's, which may lie up to one texel beyond its edges (not
/// beyond a corner): there, that of the neighbouring face.
std::size_t cube_texel_index(int face, int x, int y, int size);

} // namespace kokage
