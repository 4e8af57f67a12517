#include "reflection/maps/face_chart.h"

#include "common/services/random.h"
#include "tests/unit/common/scene_builders.h"

#include <cmath>
#include <gtest/gtest.h>

namespace kokage {
namespace {

using test::random_direction;

TEST(FaceChart, PlacesAndDirectionsAreInverse) {
    Random random(7);
    for (int i = 0; i < 5000; ++i) {
        const glm::vec3 direction = random_direction(random);
        const FacePlace place = face_place(3.f * direction);
        ASSERT_LE(std::max(std::abs(place.u), std::abs(place.v)), 1.000001f);
        ASSERT_LT(glm::length(glm::vec3(face_direction(place.face, place.u, place.v)) - direction), 3e-7f);
    }
}

TEST(FaceChart, FacesStandWhereOpenGlHasThem) {
    // OpenGL 4.6, table 8.19, written out: direction of the face's middle, of growing s, of growing t.
    const glm::dvec3 faces[6][3] = {{{1, 0, 0}, {0, 0, -1}, {0, -1, 0}}, {{-1, 0, 0}, {0, 0, 1}, {0, -1, 0}},
                                    {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}},   {{0, -1, 0}, {1, 0, 0}, {0, 0, -1}},
                                    {{0, 0, 1}, {1, 0, 0}, {0, -1, 0}},  {{0, 0, -1}, {-1, 0, 0}, {0, -1, 0}}};
    for (int face = 0; face < 6; ++face) {
        EXPECT_LT(glm::length(face_direction(face, 0, 0) - faces[face][0]), 1e-15);
        EXPECT_GT(glm::dot(face_direction(face, 0.5, 0), faces[face][1]), 0.3);
        EXPECT_GT(glm::dot(face_direction(face, 0, 0.5), faces[face][2]), 0.3);
    }
}

TEST(FaceChart, RowsAreEvenlySpacedInAngle) {
    for (int i = 0; i < 8; ++i) {
        const double u = -1 + i * 0.25;
        const double cosine = glm::dot(face_direction(2, u, 0), face_direction(2, u + 0.25, 0));
        EXPECT_NEAR(std::acos(cosine), kPiDouble / 16, 1e-12);
    }
}

TEST(FaceChart, PlacesAlongAnEdgeAreTheSameInBothFaces) {
    // Each texel row on an edge is, as a set of directions, a texel row of another face.
    const int n = 9;
    for (int face = 0; face < 6; ++face)
        for (int edge = 0; edge < 4; ++edge)
            for (int i = 0; i < n; ++i) {
                const double along = -1 + 2.0 * i / (n - 1), on = edge % 2 == 0 ? -1 : 1;
                const glm::dvec3 d = edge < 2 ? face_direction(face, on, along) : face_direction(face, along, on);
                int found = 0;
                for (int other = 0; other < 6; ++other)
                    for (int k = 0; k < n * n; ++k)
                        found += glm::length(
                                     face_direction(other, -1 + 2.0 * (k % n) / (n - 1), -1 + 2.0 * (k / n) / (n - 1)) -
                                     d) < 1e-12;
                ASSERT_EQ(found, i == 0 || i == n - 1 ? 3 : 2);
            }
}

} // namespace
} // namespace kokage
