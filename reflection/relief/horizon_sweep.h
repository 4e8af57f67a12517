#pragma once
// Horizons of all texels in one direction, by a sweep. Private to relief.
//
// V. Timonen, J. Westerholm, Scalable Height Field Self-Shadowing (2010): along a line over the relief, the points that
// can still be a horizon for what comes later are the upper convex hull of those passed, kept as a stack; a new point
// takes down what it hides, sees its horizon on top, and joins. So a horizon costs the same few steps however far away
// it is. Here lines have rational slopes, (p, q) texels a step: each texel lies on one line of every direction, and the
// points between are where the line crosses the borders of cells.
#include "reflection/relief/height_field.h"

#include <span>
#include <vector>

namespace kokage {

struct HorizonDirection {
    int p = 1, q = 0;   ///< texels along u and v, coprime: horizons are looked for towards there
    double azimuth = 0; ///< on the surface, from +u towards +v, in [0, 2π)
    double share = 1;   ///< of all azimuths: half the angles to its neighbours on both sides
};

/// About `count` directions, all around, nearly evenly spaced on a surface of that scale; in order of azimuth.
std::vector<HorizonDirection> horizon_directions(const HeightField& field, const ReliefScale& scale, int count);

class HorizonSweep {
  public:
    HorizonSweep(const HeightField& field, const ReliefScale& scale);

    /// For each texel (row * width + column) the tangent >= 0 of its horizon's elevation. On all threads; the same bits
    /// on any number of them.
    void run(const HorizonDirection& direction, std::span<float> tangents) const;

  private:
    struct Line;
    struct Vertex;
    std::vector<Vertex> vertices_of_step(int p, int q) const;
    std::vector<Line> lines_of(int p, int q, std::size_t before) const;

    const HeightField& field_;
    glm::dvec2 texel_m_;
    double reach_m_; ///< further away nothing can raise a horizon by much
    int stride_ = 0;
    std::vector<float> heights_; ///< metres, negative; with a border of kMargin texels all around
};

} // namespace kokage
