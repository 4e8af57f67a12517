#pragma once
// Colours of an OBJ's vertices: "v x y z r g b", which the format does not know but MeshLab, Blender, ZBrush and others
// write. Private to common/obj.
#include "common/types.h"

#include <cstddef>
#include <string_view>
#include <vector>

namespace kokage {

class ObjVertexColors {
  public:
    /// A line of the file, without its end. Lines that are no vertices are passed over.
    void read_line(std::string_view line);

    bool empty() const { return !any_; }
    /// Linear; white where the vertex has none. The file's numbers are taken as sRGB, 0..1, or 0..255 where any of them
    /// is above 1.
    glm::vec3 of_vertex(std::size_t vertex) const;

  private:
    std::vector<glm::vec3> colors_; ///< of the vertices up to the last that has one
    std::size_t vertices_ = 0;
    bool any_ = false;
    float largest_ = 0;
};

} // namespace kokage
