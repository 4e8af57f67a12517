#include "foliage/bundles/bundle_tracing.h"

#include "common/services/error.h"
#include "common/services/parallel.h"
#include "common/services/random.h"

#include <algorithm>
#include <cmath>

namespace kokage::bundles {
namespace {

RasterScratch& scratch_of_thread() {
    thread_local RasterScratch scratch;
    return scratch;
}

glm::vec2 grid_jitter(std::uint64_t seed, std::size_t direction) {
    Random random(seed, direction);
    const float u = random.uniform();
    return {u, random.uniform()};
}

std::uint8_t fraction(std::uint32_t open, std::uint32_t of) {
    return of == 0 ? OpenFractions::kUnseen : std::uint8_t(float(open) / float(of) * 254 + 0.5f);
}

/// Turns a raster's counts into one row of open fractions.
void store_open(const Facets& facets, const RasterScratch& raster, std::size_t row, OpenFractions& open, bool both) {
    const std::uint32_t leaves = facets.leaf_facet_count;
    std::uint8_t* near_row = open.near_end.data() + row * open.facet_count;
    std::uint8_t* far_row = both ? open.far_end.data() + row * open.facet_count : nullptr;
    for (std::uint32_t f = 0; f < leaves; ++f) {
        near_row[f] = fraction(raster.near_count[f], raster.fragments[f]);
        if (both)
            far_row[f] = fraction(raster.far_count[f], raster.fragments[f]);
    }
    for (std::uint32_t f = leaves; f < open.facet_count; ++f) {
        const std::uint32_t face =
            leaves + 2 * (f - leaves); // the front looks to the near end; face + 1: to the far end
        const std::uint32_t of = raster.fragments[face] + raster.fragments[face + 1];
        near_row[f] = fraction(raster.near_count[face], of);
        if (both)
            far_row[f] = fraction(raster.far_count[face + 1], of);
    }
}

/// A side, and whether it is the inside of wood.
struct FacingSide {
    static constexpr std::uint32_t kInsideWood = 0x80000000u;
    std::uint32_t value;
    Side side() const { return value & ~kInsideWood; }
    bool inside_wood() const { return (value & kInsideWood) != 0; }
};

/// Which side of a patch looks to the near and to the far end of lines of one direction.
struct FaceSides {
    FacingSide near_side, far_side;
};

/// For every face.
void face_sides(const Facets& facets, const glm::vec3& direction, std::vector<FaceSides>& sides) {
    sides.resize(facets.face_count());
    for (std::uint32_t f = 0; f < facets.leaf_facet_count; ++f) {
        const Side front = 2 * facets.facets[f].patch;
        const bool front_is_near = glm::dot(facets.facets[f].normal, direction) < 0;
        sides[f] = {{front + !front_is_near}, {front + front_is_near}};
    }
    for (std::uint32_t f = facets.leaf_facet_count, face = f; f < facets.facets.size(); ++f, face += 2) {
        const FacingSide front{2 * facets.facets[f].patch}, inside{(front.value + 1) | FacingSide::kInsideWood};
        sides[face] = {front, inside};
        sides[face + 1] = {inside, front};
    }
}

struct Pair {
    std::uint32_t a, b; ///< the two sides that face each other: FacingSide::value
};

struct DirectionLinks {
    UninitializedVector<Pair> pairs;
    std::vector<Links::GroundLink> ground;
};

/// Where pixel (0, 0)'s line meets the ground, and how that moves from pixel to pixel.
struct GroundProjection {
    glm::vec2 origin, along_u, along_v;
    bool valid = false;
};

GroundProjection project_to_ground(const GroundGrid& grid, const Projection& projection) {
    const glm::vec3& d = projection.direction;
    if (d.y > -1e-3f) // lines this flat leave the grid
        return {};
    auto point = [&](float u, float v) {
        const glm::vec3 on_plane =
            ((u - projection.offset.x) * projection.u_axis + (v - projection.offset.y) * projection.v_axis) /
            projection.pixels_per_unit;
        const glm::vec3 hit = on_plane + d * ((grid.height - on_plane.y) / d.y);
        return glm::vec2(hit.x, hit.z);
    };
    const glm::vec2 origin = point(0, 0);
    return {origin, point(1, 0) - origin, point(0, 1) - origin, true};
}

/// What the walls inside wood see of each other is nobody's light and is left out; leaves that reach into the wood
/// (most do, at their stalk) see the dark wall.
void collect_links(const RasterScratch& raster, const Projection& projection, const std::vector<FaceSides>& sides,
                   std::uint32_t face_mask, const std::optional<GroundGrid>& grid, std::uint32_t phase,
                   DirectionLinks& out) {
    const GroundProjection on_ground = grid ? project_to_ground(*grid, projection) : GroundProjection{};
    out.pairs.resize(raster.fragment_count);
    Pair* pair = out.pairs.data();
    for (int y = 0; y < projection.height; ++y)
        for (int x = 0; x < projection.width; ++x) {
            const std::size_t pixel = std::size_t(y) * projection.width + x;
            const std::uint32_t begin = raster.pixel_begin[pixel], end = raster.pixel_begin[pixel + 1];
            if (begin == end)
                continue;
            FacingSide open = sides[raster.sorted_keys[begin] & face_mask].far_side;
            for (std::uint32_t i = begin + 1; i < end; ++i) {
                const FaceSides face = sides[raster.sorted_keys[i] & face_mask];
                *pair = {open.value, face.near_side.value};
                pair += !(open.inside_wood() && face.near_side.inside_wood());
                open = face.far_side;
            }
            constexpr std::uint32_t stride = GroundGrid::kStride;
            if (on_ground.valid && !open.inside_wood() && (std::uint32_t(x) + phase) % stride == 0 &&
                (std::uint32_t(y) + phase / stride) % stride == 0) {
                const glm::vec2 hit = on_ground.origin + float(x) * on_ground.along_u + float(y) * on_ground.along_v;
                if (const int texel = grid->texel_at(hit.x, hit.y); texel >= 0)
                    out.ground.push_back({open.side(), std::uint32_t(texel)});
            }
        }
    out.pairs.resize(std::size_t(pair - out.pairs.data()));
}

/// Rows are found by 32-bit numbers: 17 GB of links.
void require_countable(std::uint64_t links) {
    if (links > 0xffffffffull)
        throw InputError("bundles: so many lines would need " + std::to_string(links) +
                         " links, more than 4 thousand million: ask for a larger error (--error), less effort, or "
                         "path-traced");
}

/// Compressed rows from pairs. The halves fill disjoint parts of each row, each in the order of its directions.
void compress(const PatchScene& scene, const std::vector<DirectionLinks>& directions, std::uint32_t half,
              Links& links) {
    const std::size_t side_count = 2 * scene.patches.size();
    const auto inside_wood = [&](Side side) {
        return side % 2 == 1 && scene.patches[side / 2].kind == PatchKind::bark;
    };
    std::vector<std::uint32_t> cursor[2];
    const std::size_t bounds[3] = {0, half, directions.size()};
    parallel_blocks(2, 1, [&](std::size_t h, std::size_t) {
        cursor[h].assign(side_count, 0);
        for (std::size_t d = bounds[h]; d < bounds[h + 1]; ++d)
            for (const Pair& pair : directions[d].pairs)
                for (const FacingSide facing : {FacingSide{pair.a}, FacingSide{pair.b}})
                    cursor[h][facing.side()] += !facing.inside_wood();
    });
    links.begin.resize(side_count + 1);
    links.middle.resize(side_count);
    std::uint64_t all = side_count;
    for (const DirectionLinks& direction : directions)
        all += 2 * direction.pairs.size();
    require_countable(all);
    std::uint32_t running = 0;
    std::vector<Side> lonely;
    for (std::size_t s = 0; s < side_count; ++s) {
        std::uint32_t first = cursor[0][s];
        const std::uint32_t second = cursor[1][s];
        if (first + second == 0) {
            first = 1;
            lonely.push_back(Side(s));
        }
        links.begin[s] = cursor[0][s] = running;
        links.middle[s] = cursor[1][s] = running + first;
        running += first + second;
    }
    links.begin[side_count] = running;
    links.neighbours.resize(running);
    // The inside of wood is as dim as a second reflection of its outside. Another side that meets nobody (hidden in
    // wood, or all its lines end outside) takes what its open share leaves from the patch before it, its neighbour on
    // the branch. Rows stay stochastic.
    for (Side side : lonely) {
        links.neighbours[links.begin[side]] = inside_wood(side) ? side - 1
                                              : side >= 2       ? side - 2
                                                          : std::min<Side>(side + 2, Side(side_count) - 2 + side % 2);
    }
    parallel_blocks(2, 1, [&](std::size_t h, std::size_t) {
        for (std::size_t d = bounds[h]; d < bounds[h + 1]; ++d)
            for (const Pair& pair : directions[d].pairs) {
                const FacingSide a{pair.a}, b{pair.b};
                if (!a.inside_wood())
                    links.neighbours[cursor[h][a.side()]++] = b.side();
                if (!b.inside_wood())
                    links.neighbours[cursor[h][b.side()]++] = a.side();
            }
    });
}

OpenFractions make_open(std::size_t directions, const Facets& facets, bool both) {
    OpenFractions open;
    open.facet_count = facets.facets.size();
    open.near_end.resize(directions * open.facet_count);
    if (both)
        open.far_end.resize(directions * open.facet_count);
    return open;
}

} // namespace

float pixel_density(const Facets& facets, float pixels) {
    const double extent = glm::length(facets.high - facets.low);
    // The mean projected area of a leaf is half its area.
    const double wanted = std::sqrt(pixels / std::max(0.5 * facets.mean_leaf_area, 1e-30));
    return float(std::clamp(wanted, 1.0, std::max(8192.0 / std::max(extent, 1e-6), 1.0)));
}

GroundGrid make_ground_grid(const Facets& facets, float height_m) {
    GroundGrid grid;
    grid.height = float((double(height_m) - facets.centre.y) * facets.scale);
    const glm::vec3 size = facets.high - facets.low, middle = 0.5f * (facets.low + facets.high);
    // Shadows of a sun 20 degrees above the horizon stay inside.
    const float half = 0.75f * std::max(size.x, size.z) + 2 * std::max(size.y, facets.high.y - grid.height);
    grid.low = glm::vec2(middle.x, middle.z) - half;
    grid.texel = std::max(2 * half / GroundGrid::kSize, 1e-6f);
    return grid;
}

BundleTransport trace_bundles(const PatchScene& scene, const Facets& facets, const BundleSettings& settings,
                              Progress& progress) {
    BundleTransport transport;
    transport.sky_lines = make_line_directions(settings.sky_directions, hash64(settings.seed) + 1);
    transport.link_lines = make_line_directions(settings.link_directions, hash64(settings.seed) + 2);
    if (scene.ground)
        transport.ground = make_ground_grid(facets, scene.ground->height_m);
    const std::size_t skies = transport.sky_lines.directions.size(), linked = transport.link_lines.directions.size();
    transport.sky_open = make_open(skies, facets, true);
    transport.link_open = make_open(linked, facets, true);
    const float sky_density = pixel_density(facets, settings.sky_pixels),
                link_density = pixel_density(facets, settings.link_pixels);
    transport.sky_open.pixels_per_area = sky_density * sky_density;
    transport.link_open.pixels_per_area = link_density * link_density;
    const std::uint32_t face_mask = (1u << face_bits(facets)) - 1;

    std::vector<DirectionLinks> collected(linked);
    std::vector<std::size_t> fragments(skies + linked, 0);
    transport.links.ground_pixel_area.resize(linked);
    progress.begin("drawing line bundles", skies + linked);
    parallel_blocks(skies + linked, 1, [&](std::size_t task, std::size_t) {
        progress.throw_if_stopped();
        RasterScratch& raster = scratch_of_thread();
        const glm::vec2 jitter = grid_jitter(settings.seed, task);
        if (task < linked) {
            const glm::vec3& direction = transport.link_lines.directions[task];
            const Projection projection = fit_projection(facets, direction, link_density, jitter);
            draw_fragments(scene, facets, projection, raster);
            store_open(facets, raster, task, transport.link_open, true);
            thread_local std::vector<FaceSides> sides;
            face_sides(facets, direction, sides);
            const auto phase = std::uint32_t(hash64(settings.seed * 977 + task));
            collect_links(raster, projection, sides, face_mask, transport.ground, phase, collected[task]);
            transport.links.ground_pixel_area[task] =
                float(GroundGrid::kStride * GroundGrid::kStride) / (link_density * link_density);
        } else {
            const glm::vec3& direction = transport.sky_lines.directions[task - linked];
            draw_ends(scene, facets, fit_projection(facets, direction, sky_density, jitter), true, raster);
            store_open(facets, raster, task - linked, transport.sky_open, true);
        }
        for (std::uint32_t count : raster.fragments)
            fragments[task] += count;
        progress.advance(1);
    });
    for (std::size_t count : fragments)
        transport.fragments += count;

    transport.links.ground_begin.push_back(0);
    for (const DirectionLinks& direction : collected) {
        transport.links.ground.insert(transport.links.ground.end(), direction.ground.begin(), direction.ground.end());
        transport.links.ground_begin.push_back(std::uint32_t(transport.links.ground.size()));
    }
    compress(scene, collected, transport.link_lines.half, transport.links);
    return transport;
}

BeamVisibility trace_beams(const PatchScene& scene, const Facets& facets, const std::optional<GroundGrid>& ground,
                           const std::vector<glm::vec3>& directions_to_light, float pixels, std::uint64_t seed) {
    BeamVisibility visibility;
    visibility.open = make_open(directions_to_light.size(), facets, false);
    visibility.ground_shadow.resize(ground ? directions_to_light.size() : 0);
    const float density = pixel_density(facets, pixels);
    parallel_blocks(directions_to_light.size(), 1, [&](std::size_t beam, std::size_t) {
        RasterScratch& raster = scratch_of_thread();
        const Projection projection =
            fit_projection(facets, -directions_to_light[beam], density, grid_jitter(seed, beam));
        draw_ends(scene, facets, projection, false, raster);
        store_open(facets, raster, beam, visibility.open, false);
        if (!ground)
            return;
        std::vector<float>& shadow = visibility.ground_shadow[beam];
        shadow.assign(GroundGrid::kSize * GroundGrid::kSize, 0.f);
        const GroundProjection on_ground = project_to_ground(*ground, projection);
        if (!on_ground.valid)
            return;
        constexpr int stride = 4;
        const float pixel_area = float(stride * stride) / (density * density);
        const float share = pixel_area / (std::abs(projection.direction.y) * ground->texel * ground->texel);
        for (int y = 0; y < projection.height; y += stride)
            for (int x = 0; x < projection.width; x += stride) {
                if (raster.near_keys[std::size_t(y) * projection.width + x] == kNoKey)
                    continue;
                const glm::vec2 hit = on_ground.origin + float(x) * on_ground.along_u + float(y) * on_ground.along_v;
                if (const int texel = ground->texel_at(hit.x, hit.y); texel >= 0)
                    shadow[texel] += share;
            }
        for (float& s : shadow)
            s = std::min(s, 1.f);
    });
    return visibility;
}

std::size_t BundleTransport::bytes() const {
    auto size = [](const auto& v) { return v.size() * sizeof(v[0]); };
    return size(sky_open.near_end) + size(sky_open.far_end) + size(link_open.near_end) + size(link_open.far_end) +
           size(links.begin) + size(links.middle) + size(links.neighbours) + size(links.ground) +
           size(links.ground_begin) + size(links.ground_pixel_area) + size(sky_lines.directions) +
           size(link_lines.directions) + rays.bytes();
}

} // namespace kokage::bundles
