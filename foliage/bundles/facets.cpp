#include "foliage/bundles/facets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace kokage::bundles {
namespace {

// Two triangles are taken to lie in one plane when their normals differ by less than about a degree.
constexpr float kSamePlaneCosine = 0.9998f;
// Bark has one radiance however its pieces are turned, so a tube's slightly twisted quads may pass as flat: within six
// degrees, less than the sides of a tube of up to 60 make with each other.
constexpr float kNearlyFlatCosine = 0.995f;

/// Texture coordinates as an affine function of scaled position.
struct TextureMap {
    glm::vec3 point; ///< a point of the polygon, scaled
    glm::vec2 uv;    ///< its texture coordinate
    glm::vec3 u_gradient, v_gradient;
};

struct Outline {
    std::array<glm::vec3, PolygonGroup::kMaxCorners> corners;
    int count = 0;
    std::int16_t mask = -1;
    glm::vec3 normal{0.f};
    float area = 0, solid_area = 0;
    TextureMap texture{};
};

struct Corner {
    glm::vec3 position;
    glm::vec2 uv;
};

TextureMap texture_map(const Corner (&corner)[3], const glm::vec3& normal) {
    const glm::vec3 e1 = corner[1].position - corner[0].position, e2 = corner[2].position - corner[0].position;
    const float twice_area = glm::dot(glm::cross(e1, e2), normal);
    // Gradients of the barycentric coordinates of corners 1 and 2 in the plane.
    const glm::vec3 g1 = glm::cross(e2, normal) / twice_area, g2 = glm::cross(normal, e1) / twice_area;
    const glm::vec2 d1 = corner[1].uv - corner[0].uv, d2 = corner[2].uv - corner[0].uv;
    return {corner[0].position, corner[0].uv, g1 * d1.x + g2 * d2.x, g1 * d1.y + g2 * d2.y};
}

glm::vec2 mapped_uv(const TextureMap& map, const glm::vec3& position) {
    const glm::vec3 offset = position - map.point;
    return map.uv + glm::vec2(glm::dot(map.u_gradient, offset), glm::dot(map.v_gradient, offset));
}

bool convex_at(const Outline& outline, int i) {
    const int n = outline.count;
    const glm::vec3 a = outline.corners[(i + n - 1) % n], b = outline.corners[i], c = outline.corners[(i + 1) % n];
    const glm::vec3 ab = b - a, bc = c - b;
    const float turn = glm::dot(glm::cross(ab, bc), outline.normal);
    return turn >= 0 || turn >= -1e-4f * glm::length(ab) * glm::length(bc);
}

/// Adds a triangle to an outline across a shared edge if the union stays flat, convex and equally textured.
bool try_merge(Outline& outline, const Corner (&triangle)[3], std::int16_t mask, const glm::vec3& normal, float area,
               float solid_area, bool bark) {
    if (outline.count >= PolygonGroup::kMaxCorners || mask != outline.mask ||
        glm::dot(normal, outline.normal) < (bark ? kNearlyFlatCosine : kSamePlaneCosine))
        return false;
    for (int e = 0; e < 3; ++e) {
        const glm::vec3 &a = triangle[e].position, &b = triangle[(e + 1) % 3].position;
        for (int i = 0; i < outline.count; ++i) {
            // The triangle's edge a->b runs against the outline's edge.
            if (outline.corners[i] != b || outline.corners[(i + 1) % outline.count] != a)
                continue;
            const Corner& apex = triangle[(e + 2) % 3];
            if (mask >= 0 && glm::length(mapped_uv(outline.texture, apex.position) - apex.uv) > 1e-3f)
                return false;
            const int corners = outline.count;
            for (int j = corners; j > i + 1; --j)
                outline.corners[j] = outline.corners[j - 1];
            outline.corners[i + 1] = apex.position;
            ++outline.count;
            for (int j = i; j <= i + 2; ++j)
                if (!convex_at(outline, j % outline.count)) { // as it was
                    for (int k = i + 1; k < corners; ++k)
                        outline.corners[k] = outline.corners[k + 1];
                    outline.count = corners;
                    return false;
                }
            if (bark)
                outline.normal = glm::normalize(outline.area * outline.normal + area * normal);
            outline.area += area;
            outline.solid_area += solid_area;
            return true;
        }
    }
    return false;
}

/// Bounds of polygons, column by column of the scene: every polygon widens the box of the column that its first corner
/// stands in.
class BoxColumns {
  public:
    explicit BoxColumns(const Facets& facets)
        : low_(facets.low), columns_a_unit_(float(kColumns) / glm::max(facets.high - facets.low, 1e-20f)) {
        constexpr float far = std::numeric_limits<float>::max();
        columns_.fill({glm::vec3(far), glm::vec3(-far)});
    }
    void add(const glm::vec3& first_corner, const glm::vec3& corner) {
        const glm::vec3 along = (first_corner - low_) * columns_a_unit_;
        const auto column = [](float place) { return std::size_t(std::clamp(place, 0.f, float(kColumns - 1))); };
        Box& box = columns_[column(along.z) * kColumns + column(along.x)];
        box.low = glm::min(box.low, corner);
        box.high = glm::max(box.high, corner);
    }
    /// Of columns with polygons.
    std::vector<Box> boxes() const {
        std::vector<Box> boxes;
        for (const Box& column : columns_)
            if (column.low.x <= column.high.x)
                boxes.push_back(column);
        return boxes;
    }

  private:
    static constexpr int kColumns = 16; ///< in x and in z
    glm::vec3 low_, columns_a_unit_;
    std::array<Box, std::size_t(kColumns) * kColumns> columns_;
};

class Builder {
  public:
    Builder(const PatchScene& scene, Facets& facets)
        : scene_(scene), solid_shares_(solid_shares(scene)), facets_(facets), centre_(facets.centre),
          scale_(float(facets.scale)), columns_(facets) {}

    void add_patch(std::uint32_t index) {
        facets_.patch_first_facet.push_back(std::uint32_t(facets_.facets.size()));
        first_facet_ = facets_.facets.size();
        const Patch& patch = scene_.patches[index];
        const bool bark = patch.kind == PatchKind::bark;
        Outline outline;
        for (std::uint32_t t = 0; t < patch.triangle_count; ++t) {
            const std::uint32_t triangle = patch.first_triangle + t;
            Corner corner[3];
            for (int k = 0; k < 3; ++k) {
                const std::uint32_t vertex = scene_.triangles[triangle][k];
                corner[k].position = scaled(scene_.positions[vertex]);
                corner[k].uv = scene_.uvs.empty() ? glm::vec2(0.f) : scene_.uvs[vertex];
            }
            const glm::vec3 cross =
                glm::cross(corner[1].position - corner[0].position, corner[2].position - corner[0].position);
            const float length = glm::length(cross);
            if (!(length > 1e-18f) || !std::isfinite(length))
                continue;
            const glm::vec3 normal = cross * (1 / length);
            const auto mask = scene_.masked(triangle) ? scene_.triangle_mask[triangle] : std::int16_t(-1);
            const float area = 0.5f * length,
                        solid_area = solid_shares_.empty() ? area : area * solid_shares_[triangle];
            if (outline.count > 0 && try_merge(outline, corner, mask, normal, area, solid_area, bark))
                continue;
            flush(outline, index, bark);
            outline.count = 3;
            for (int k = 0; k < 3; ++k)
                outline.corners[k] = corner[k].position;
            outline.mask = mask;
            outline.normal = normal;
            outline.area = area;
            outline.solid_area = solid_area;
            if (mask >= 0)
                outline.texture = texture_map(corner, normal);
        }
        flush(outline, index, bark);
    }

    void store_boxes() { facets_.boxes = columns_.boxes(); }

    void store_groups() {
        for (auto& of_corners : groups_)
            for (PolygonGroup& group : of_corners) {
                if (group.count == 0)
                    continue;
                resize(group, group.count);
                facets_.groups.push_back(std::move(group));
            }
    }

  private:
    glm::vec3 scaled(const glm::vec3& position) const { return (position - centre_) * scale_; }

    void flush(Outline& outline, std::uint32_t patch, bool bark) {
        if (outline.count == 0)
            return;
        const std::uint32_t facet = facet_for(outline, patch, bark);
        add_area(facets_.facets[facet], outline);
        for (int k = 0; k < outline.count; ++k)
            columns_.add(outline.corners[0], outline.corners[k]);
        add_polygon(outline,
                    bark ? (facets_.leaf_facet_count + 2 * (facet - facets_.leaf_facet_count)) | PolygonGroup::kBark
                         : facet);
        outline.count = 0;
    }

    void add_polygon(const Outline& outline, std::uint32_t face) {
        const bool masked = outline.mask >= 0;
        PolygonGroup& group = groups_[std::size_t(outline.count - kFewestCorners)][masked];
        if (group.face.size() < group.count + 1 + PolygonGroup::kPadding) {
            group.corners = outline.count;
            group.masked = masked;
            // Most trees are pairs of triangles.
            resize(group,
                   std::max(2 * group.count, outline.count == 4 ? scene_.triangles.size() / 2 : std::size_t(64)));
        }
        const std::size_t i = group.count++;
        for (std::size_t k = 0; k < std::size_t(outline.count); ++k) {
            group.x[k][i] = outline.corners[k].x;
            group.y[k][i] = outline.corners[k].y;
            group.z[k][i] = outline.corners[k].z;
        }
        group.normal_x[i] = outline.normal.x;
        group.normal_y[i] = outline.normal.y;
        group.normal_z[i] = outline.normal.z;
        group.face[i] = face;
        if (masked)
            add_texture(outline, i, group.texels);
    }

    void add_texture(const Outline& outline, std::size_t polygon, TexelMaps& texels) const {
        const AlphaMask& mask = scene_.masks[std::size_t(outline.mask)];
        const glm::vec2 size(float(mask.alpha->width), float(mask.alpha->height));
        texels.mask[polygon] = outline.mask;
        glm::vec2 low(1.f), high(0.f);
        for (int k = 0; k < outline.count; ++k) {
            const glm::vec2 uv = mapped_uv(outline.texture, outline.corners[k]);
            low = glm::min(low, uv);
            high = glm::max(high, uv);
        }
        constexpr float kTolerated = 1e-4f;
        const bool inside = std::min(low.x, low.y) >= -kTolerated && std::max(high.x, high.y) <= 1 + kTolerated;
        texels.wraps[polygon] = inside ? 0.f : 1.f;
        const glm::vec2 uv = mapped_uv(outline.texture, outline.corners[0]);
        for (int axis = 0; axis < 2; ++axis) {
            const glm::vec3& gradient = axis == 0 ? outline.texture.u_gradient : outline.texture.v_gradient;
            texels.at_corner[std::size_t(axis)][polygon] = size[axis] * uv[axis];
            for (int c = 0; c < 3; ++c)
                texels.gradient[std::size_t(axis)][std::size_t(c)][polygon] = size[axis] * gradient[c];
        }
    }

    static void resize(PolygonGroup& group, std::size_t count) {
        const std::size_t padded = count + PolygonGroup::kPadding;
        for (auto* axis : {&group.x, &group.y, &group.z})
            for (std::size_t k = 0; k < std::size_t(group.corners); ++k)
                (*axis)[k].resize(padded);
        for (auto* axis : {&group.normal_x, &group.normal_y, &group.normal_z})
            axis->resize(padded);
        group.face.resize(padded);
        if (!group.masked)
            return;
        group.texels.mask.resize(padded);
        group.texels.wraps.resize(padded);
        for (std::size_t axis = 0; axis < 2; ++axis) {
            group.texels.at_corner[axis].resize(padded);
            for (auto& component : group.texels.gradient[axis])
                component.resize(padded);
        }
    }

    static void add_area(Facet& facet, const Outline& outline) {
        const glm::vec3 n = outline.normal;
        const float moments[6] = {n.x * n.x, n.y * n.y, n.z * n.z, n.x * n.y, n.x * n.z, n.y * n.z};
        for (int i = 0; i < 6; ++i)
            facet.form[i] += outline.solid_area * moments[i];
        facet.area += outline.solid_area;
        facet.masked = facet.masked || outline.mask >= 0;
    }

    std::uint32_t facet_for(const Outline& outline, std::uint32_t patch, bool bark) {
        for (std::size_t f = first_facet_; f < facets_.facets.size(); ++f)
            if (bark || glm::dot(facets_.facets[f].normal, outline.normal) >= kSamePlaneCosine)
                return std::uint32_t(f);
        Facet facet;
        facet.normal = bark ? glm::vec3(0.f) : outline.normal;
        facet.patch = patch;
        facet.bark = bark;
        facets_.facets.push_back(facet);
        if (!bark)
            facets_.leaf_facet_count = std::uint32_t(facets_.facets.size());
        return std::uint32_t(facets_.facets.size() - 1);
    }

    const PatchScene& scene_;
    const std::vector<float> solid_shares_; ///< per triangle; empty without masks
    Facets& facets_;
    const glm::vec3 centre_; ///< a float itself, so that differences from it are as exact as the positions are
    const float scale_;
    std::size_t first_facet_ = 0;
    BoxColumns columns_;
    static constexpr int kFewestCorners = 3;
    /// By corners, without and with masks.
    std::array<std::array<PolygonGroup, 2>, PolygonGroup::kMaxCorners - kFewestCorners + 1> groups_;
};

void measure(const PatchScene& scene, Facets& facets) {
    facets.patch_area.assign(facets.patch_count, 0.f);
    for (Facet& facet : facets.facets) {
        facets.patch_area[facet.patch] += facet.area;
        // sqrt(mean (n.d)^2) exceeds mean |n.d|: by nothing for a plane, by pi / (2 sqrt 2) for a tube.
        const float excess = facet.bark ? 8 / (kPi * kPi) : 1.f;
        for (float& moment : facet.form)
            moment *= facet.area > 0 ? excess / facet.area : 0.f;
    }
    double leaf_area = 0, any_area = 0;
    std::size_t leaves = 0, any = 0;
    for (std::uint32_t p = 0; p < facets.patch_count; ++p) {
        if (!(facets.patch_area[p] > 0))
            continue;
        any_area += facets.patch_area[p];
        ++any;
        if (scene.patches[p].kind == PatchKind::leaf) {
            leaf_area += facets.patch_area[p];
            ++leaves;
        }
    }
    facets.mean_leaf_area = leaves ? float(leaf_area / double(leaves)) : any ? float(any_area / double(any)) : 0.f;
}

/// See Facets::wide_patches.
void set_wide_patches_apart(const PatchScene& scene, Facets& facets) {
    constexpr float kWide = 256; // times as large as a leaf
    facets.drawn = {facets.low, facets.high};
    if (scene.ground || scene.leaf_count == 0)
        return;
    double wide_area = 0, other_area = 0;
    for (std::uint32_t p = 0; p < facets.patch_count; ++p) {
        const float area = facets.patch_area[p];
        const bool wide = scene.patches[p].kind == PatchKind::bark && area > kWide * facets.mean_leaf_area;
        (wide ? wide_area : other_area) += double(area);
        if (wide)
            facets.wide_patches.push_back(p);
    }
    if (wide_area <= other_area) {
        facets.wide_patches.clear();
        return;
    }
    std::vector<std::uint8_t> wide(facets.patch_count, 0);
    for (const std::uint32_t p : facets.wide_patches)
        wide[p] = 1;
    BoxColumns columns(facets);
    for (const PolygonGroup& group : facets.groups)
        for (std::size_t i = 0; i < group.count; ++i)
            if (!wide[facets.facets[facets.facet_of(group.face[i] & ~PolygonGroup::kBark)].patch])
                for (std::size_t k = 0; k < std::size_t(group.corners); ++k)
                    columns.add({group.x[0][i], group.y[0][i], group.z[0][i]},
                                {group.x[k][i], group.y[k][i], group.z[k][i]});
    facets.boxes = columns.boxes();
    facets.drawn = facets.boxes.empty() ? Box{} : facets.boxes.front();
    for (const Box& box : facets.boxes) {
        facets.drawn.low = glm::min(facets.drawn.low, box.low);
        facets.drawn.high = glm::max(facets.drawn.high, box.high);
    }
}

MaskBits pack(const std::vector<AlphaMask>& masks) {
    constexpr int kBits = 32;
    MaskBits packed;
    for (const AlphaMask& mask : masks) {
        const Image& alpha = *mask.alpha;
        const int stride = (alpha.width + kBits - 1) / kBits;
        const std::size_t first = packed.words.size();
        packed.first.push_back(std::int32_t(first));
        packed.stride.push_back(stride);
        packed.last_column.push_back(float(alpha.width) - 0.5f);
        packed.last_row.push_back(float(alpha.height) - 0.5f);
        packed.words.resize(first + std::size_t(stride) * std::size_t(alpha.height));
        for (int y = 0; y < alpha.height; ++y)
            for (int x = 0; x < alpha.width; ++x)
                if (alpha.at(x, y)[0] >= mask.cutoff)
                    packed.words[first + std::size_t(y) * std::size_t(stride) + std::size_t(x / kBits)] |=
                        1u << (x % kBits);
    }
    return packed;
}

template <class T>
std::size_t size_in_bytes(const std::vector<T>& values) {
    return values.size() * sizeof(T);
}

} // namespace

std::size_t MaskBits::bytes() const {
    return size_in_bytes(words) + size_in_bytes(first) + size_in_bytes(stride) + size_in_bytes(last_column) +
           size_in_bytes(last_row);
}

std::size_t TexelMaps::bytes() const {
    std::size_t sum = size_in_bytes(mask) + size_in_bytes(wraps);
    for (std::size_t axis = 0; axis < 2; ++axis) {
        sum += size_in_bytes(at_corner[axis]);
        for (const auto& component : gradient[axis])
            sum += size_in_bytes(component);
    }
    return sum;
}

std::size_t PolygonGroup::bytes() const {
    std::size_t sum = size_in_bytes(face) + texels.bytes();
    for (const auto* axis : {&x, &y, &z})
        for (const auto& corner : *axis)
            sum += size_in_bytes(corner);
    for (const auto* axis : {&normal_x, &normal_y, &normal_z})
        sum += size_in_bytes(*axis);
    return sum;
}

std::size_t Facets::bytes() const {
    std::size_t sum = mask_bits.bytes() + size_in_bytes(facets) + size_in_bytes(patch_first_facet) +
                      size_in_bytes(patch_area) + size_in_bytes(wide_patches) + size_in_bytes(boxes);
    for (const PolygonGroup& group : groups)
        sum += group.bytes();
    return sum;
}

Facets make_facets(const PatchScene& scene) {
    Facets facets;
    facets.patch_count = std::uint32_t(scene.patches.size());
    glm::vec3 least(0.f), most(0.f);
    if (!scene.positions.empty())
        least = most = scene.positions[0];
    for (const glm::vec3& position : scene.positions) {
        least = glm::min(least, position);
        most = glm::max(most, position);
    }
    const glm::dvec3 low(least), high(most);
    facets.centre = glm::dvec3(glm::vec3(0.5 * (low + high)));
    const double diagonal = glm::length(high - low);
    facets.scale = diagonal > 0 ? 1 / diagonal : 1;
    facets.high = glm::vec3((high - facets.centre) * facets.scale);
    facets.low = glm::vec3((low - facets.centre) * facets.scale);

    facets.mask_bits = pack(scene.masks);
    facets.patch_first_facet.reserve(scene.patches.size() + 1);
    facets.facets.reserve(scene.patches.size());
    Builder builder(scene, facets);
    for (std::uint32_t p = 0; p < facets.patch_count; ++p)
        builder.add_patch(p);
    builder.store_groups();
    builder.store_boxes();
    facets.patch_first_facet.push_back(std::uint32_t(facets.facets.size()));
    measure(scene, facets);
    set_wide_patches_apart(scene, facets);
    return facets;
}

} // namespace kokage::bundles
