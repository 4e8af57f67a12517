#include "foliage/bundles/bundle_tracing.h"

#include "common/services/error.h"
#include "common/services/parallel.h"
#include "common/services/random.h"
#include "foliage/bundles/line_links.h"

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

/// Without branches, so that a compiler makes vectors of it.
std::uint8_t fraction(std::uint32_t open, std::uint32_t of) {
    const std::int32_t share =
        std::int32_t(float(std::int32_t(open)) / float(std::max(std::int32_t(of), 1)) * 254 + 0.5f);
    return std::uint8_t(of == 0 ? OpenFractions::kUnseen : share);
}

/// Turns a raster's counts into one row of open fractions of the near (`end` = 0) or the far end (1).
void store_open(const Facets& facets, const std::vector<std::uint32_t>& fragments,
                const std::vector<std::uint32_t>& counts, std::size_t end, std::uint8_t* row) {
    const std::size_t leaves = facets.leaf_facet_count, all = facets.facets.size();
    const std::uint32_t *of = fragments.data(), *open = counts.data();
    for (std::size_t f = 0; f < leaves; ++f)
        row[f] = fraction(open[f], of[f]);
    // The front of a face looks to the near end; face + 1: to the far end.
    for (std::size_t f = leaves, face = leaves; f < all; ++f, face += 2)
        row[f] = fraction(open[face + end], of[face] + of[face + 1]);
}

void store_open(const Facets& facets, const RasterScratch& raster, std::size_t direction, OpenFractions& open) {
    const std::size_t row = direction * open.facet_count;
    store_open(facets, raster.fragments, raster.near_count, 0, open.near_end.data() + row);
    if (!open.far_end.empty())
        store_open(facets, raster.fragments, raster.far_count, 1, open.far_end.data() + row);
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
        std::uint32_t* count = cursor[h].data();
        for (std::size_t d = bounds[h]; d < bounds[h + 1]; ++d)
            for (const auto* sides : {&directions[d].a, &directions[d].b})
                for (const std::uint32_t value : *sides)
                    count[FacingSide{value}.side()] += !FacingSide{value}.inside_wood();
    });
    std::uint64_t all = side_count;
    for (const DirectionLinks& direction : directions)
        all += 2 * direction.a.size();
    require_countable(all);
    std::vector<Side> lonely;
    for (std::size_t s = 0; s < side_count; ++s)
        if (cursor[0][s] + cursor[1][s] == 0) {
            cursor[0][s] = 1;
            lonely.push_back(Side(s));
        }
    links.lay_out(cursor[0], cursor[1]);
    for (std::size_t k = 0; k < side_count; ++k) {
        const std::size_t side = k / Links::kBlock * Links::kBlock + links.side_at[k];
        cursor[0][side] = links.begin[k];
        cursor[1][side] = links.middle[k];
    }
    // What the inside of wood would be given, below, goes to two places that are cut off afterwards.
    const std::size_t count = links.neighbours.size();
    links.neighbours.resize(count + 2);
    for (Side side : lonely)
        for (std::uint32_t h = 0; h < 2; ++h)
            cursor[h][side] = std::uint32_t(count) + h;
    parallel_blocks(2, 1, [&](std::size_t h, std::size_t) {
        Side* neighbours = links.neighbours.data();
        std::uint32_t* next = cursor[h].data();
        for (std::size_t d = bounds[h]; d < bounds[h + 1]; ++d) {
            const DirectionLinks& direction = directions[d];
            for (std::size_t i = 0; i < direction.a.size(); ++i) {
                // Without branches, which would often be foreseen wrongly.
                const FacingSide a{direction.a[i]}, b{direction.b[i]};
                neighbours[next[a.side()]] = b.side();
                next[a.side()] += !a.inside_wood();
                neighbours[next[b.side()]] = a.side();
                next[b.side()] += !b.inside_wood();
            }
        }
    });
    links.neighbours.resize(count);
    // The inside of wood is as dim as a second reflection of its outside. Another side that meets nobody (hidden in
    // wood, or all its lines end outside) takes what its open share leaves from the patch before it, its neighbour on
    // the branch. Rows stay stochastic.
    for (Side side : lonely) {
        links.neighbours[links.begin[links.place(side)]] =
            inside_wood(side) ? side - 1
            : side >= 2       ? side - 2
                              : std::min<Side>(side + 2, Side(side_count) - 2 + side % 2);
    }
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
    const double extent = glm::length(facets.drawn.high - facets.drawn.low);
    // The mean projected area of a leaf is half its area.
    const double wanted = std::sqrt(pixels / std::max(0.5 * facets.mean_leaf_area, 1e-30));
    return float(std::clamp(wanted, 1.0, std::max(8192.0 / std::max(extent, 1e-6), 1.0)));
}

GroundGrid make_ground_grid(const Facets& facets, float height_m, int directions) {
    GroundGrid grid;
    grid.height = float((double(height_m) - facets.centre.y) * facets.scale);
    const glm::vec3 size = facets.high - facets.low, middle = 0.5f * (facets.low + facets.high);
    // Shadows of a sun 20 degrees above the horizon stay inside.
    const float half = 0.75f * std::max(size.x, size.z) + 2 * std::max(size.y, facets.high.y - grid.height);
    // A spruce's lowest boughs, which lie near the ground in the edge of its own shadow, were 4 % wrong (MRE of all
    // leaves, 2,000 of them) over 32 x 32 texels with any number of lines, and 2 % over 128 x 128.
    constexpr int kLeast = 32, kMost = 128, kDirections = 64;
    const double wanted = kLeast * std::sqrt(double(directions) / kDirections);
    grid.size = std::clamp(int(wanted), kLeast, kMost);
    grid.low = glm::vec2(middle.x, middle.z) - half;
    grid.texel = std::max(2 * half / float(grid.size), 1e-6f);
    return grid;
}

BundleTransport trace_bundles(const PatchScene& scene, const Facets& facets, const BundleSettings& settings,
                              Progress& progress) {
    BundleTransport transport;
    transport.sky_lines = make_line_directions(settings.sky_directions, hash64(settings.seed) + 1);
    transport.link_lines = make_line_directions(settings.link_directions, hash64(settings.seed) + 2);
    if (scene.ground)
        transport.ground =
            make_ground_grid(facets, scene.ground->height_m, settings.sky_directions + settings.link_directions);
    const std::size_t skies = transport.sky_lines.directions.size(), linked = transport.link_lines.directions.size();
    transport.sky_open = make_open(skies, facets, true);
    transport.link_open = make_open(linked, facets, true);
    const float sky_density = pixel_density(facets, settings.sky_pixels),
                link_density = pixel_density(facets, settings.link_pixels);
    transport.sky_open.pixels_per_area = sky_density * sky_density;
    transport.link_open.pixels_per_area = link_density * link_density;

    const LeafPlanes leaves = leaf_planes(facets);
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
            store_open(facets, raster, task, transport.link_open);
            thread_local std::vector<std::uint32_t> sides;
            near_sides(facets, leaves, direction, sides);
            const auto phase = std::uint32_t(hash64(settings.seed * 977 + task));
            collect_links(raster, facets, projection, sides, transport.ground, phase, collected[task]);
            transport.links.ground_pixel_area[task] =
                float(GroundGrid::kStride * GroundGrid::kStride) / (link_density * link_density);
        } else {
            const glm::vec3& direction = transport.sky_lines.directions[task - linked];
            draw_ends(scene, facets, fit_projection(facets, direction, sky_density, jitter), true, raster);
            store_open(facets, raster, task - linked, transport.sky_open);
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
        store_open(facets, raster, beam, visibility.open);
        if (!ground)
            return;
        std::vector<float>& shadow = visibility.ground_shadow[beam];
        shadow.assign(ground->texels(), 0.f);
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
           size(links.side_at) + size(links.place_of) + size(links.begin) + size(links.middle) +
           size(links.neighbours) + size(links.ground) + size(links.ground_begin) + size(links.ground_pixel_area) +
           size(sky_lines.directions) + size(link_lines.directions) + rays.bytes();
}

} // namespace kokage::bundles
