// VoxelCube's lookup on a GPU: GLSL ES 3.00 (WebGL 2), GLSL 3.30 and later.
//
// voxelCube   VoxelCube::voxels() as a 3D texture of GL_RGB16F, GL_RGB9_E5 or GL_RGB32F, filtered LINEAR, without mips,
//             CLAMP_TO_EDGE
// voxelRange  VoxelCube::range().roughest, VoxelCube::range().smoothest, VoxelCube::scale().cube_size() / 2
//             (of a cube of 128 with its whole range: 0, 1, 64)

uniform highp sampler3D voxelCube;
uniform highp vec3 voxelRange;

/// Filtered radiance in a direction (unit) at a smoothness λ, VoxelCube::smoothness(); beyond the range, its end's.
highp vec3 voxelLookup(highp vec3 direction, highp float smoothness) {
    highp float size = float(textureSize(voxelCube, 0).x), sphere = voxelRange.z;
    highp float wanted = sphere * clamp(smoothness, voxelRange.x, voxelRange.y);
    highp float radius = min(sqrt(wanted * wanted + 1.0), sphere); // VoxelCube::centre_radius
    return textureLod(voxelCube, 0.5 + radius / size * direction, 0.0).rgb;
}
