#pragma once
// A small tree as plain arrays, from which tests build files of every kind: a trunk of six sides and twelve leaf cards.
#include <cmath>
#include <cstdint>
#include <vector>

namespace kokage {

struct PlainMesh {
    std::vector<float> positions, normals, uvs;
    std::vector<std::uint16_t> indices;
    std::size_t vertices() const { return positions.size() / 3; }
};

/// A card's place, turned about the vertical.
struct CardPlace {
    float translation[3];
    float angle;
    float scale;
};

inline std::vector<CardPlace> card_places() {
    std::vector<CardPlace> places;
    for (int i = 0; i < 12; ++i) {
        const float angle = 0.7f * float(i);
        places.push_back({{0.5f * std::cos(angle), 1.f + 0.05f * float(i), 0.5f * std::sin(angle)},
                          0.4f * float(i),
                          0.15f + 0.01f * float(i)});
    }
    return places;
}

/// Six sides between two rings of seven vertices, 12 triangles.
inline PlainMesh plain_trunk() {
    PlainMesh mesh;
    for (int ring = 0; ring < 2; ++ring)
        for (int i = 0; i <= 6; ++i) {
            const float angle = float(i) * 1.04719755f, radius = ring == 0 ? 0.1f : 0.06f;
            mesh.positions.insert(mesh.positions.end(),
                                  {radius * std::cos(angle), 1.5f * float(ring), -radius * std::sin(angle)});
            mesh.normals.insert(mesh.normals.end(), {std::cos(angle), 0.f, -std::sin(angle)});
            mesh.uvs.insert(mesh.uvs.end(), {float(i) / 6.f, float(ring)});
        }
    for (std::uint16_t i = 0; i < 6; ++i) {
        const auto low = i, high = std::uint16_t(i + 7);
        const auto next = std::uint16_t(low + 1), above = std::uint16_t(high + 1);
        mesh.indices.insert(mesh.indices.end(), {low, next, above, low, above, high});
    }
    return mesh;
}

/// A card of 1 x 1 in the xy plane, from its foot at the origin upwards.
inline PlainMesh plain_card() {
    PlainMesh mesh;
    mesh.positions = {-0.5f, 0, 0, 0.5f, 0, 0, 0.5f, 1, 0, -0.5f, 1, 0};
    mesh.normals = {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1};
    mesh.uvs = {0, 1, 1, 1, 1, 0, 0, 0};
    mesh.indices = {0, 1, 2, 0, 2, 3};
    return mesh;
}

/// All cards in their places.
inline PlainMesh plain_leaves() {
    PlainMesh mesh;
    const PlainMesh card = plain_card();
    for (const CardPlace& place : card_places()) {
        const auto first = std::uint16_t(mesh.vertices());
        const float c = std::cos(place.angle), s = std::sin(place.angle);
        for (std::size_t v = 0; v < 4; ++v) {
            const float *p = &card.positions[3 * v], *n = &card.normals[3 * v];
            const float k = place.scale;
            mesh.positions.insert(mesh.positions.end(),
                                  {place.translation[0] + k * (c * p[0] + s * p[2]), place.translation[1] + k * p[1],
                                   place.translation[2] + k * (-s * p[0] + c * p[2])});
            mesh.normals.insert(mesh.normals.end(), {c * n[0] + s * n[2], n[1], -s * n[0] + c * n[2]});
        }
        mesh.uvs.insert(mesh.uvs.end(), card.uvs.begin(), card.uvs.end());
        for (const std::uint16_t index : card.indices)
            mesh.indices.push_back(std::uint16_t(first + index));
    }
    return mesh;
}

} // namespace kokage
