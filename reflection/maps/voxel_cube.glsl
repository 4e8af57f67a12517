// VoxelCube's lookup on a GPU: GLSL ES 3.00 (WebGL 2), GLSL 3.30 and later.
//
// voxelCube  VoxelCube::voxels() as a 3D texture of GL_RGB16F, GL_RGB9_E5 or GL_RGB32F, filtered LINEAR, without mips,
//            CLAMP_TO_EDGE

uniform highp sampler3D voxelCube;

/// Filtered radiance in a direction (unit) at a smoothness λ in [0, 1], VoxelCube::smoothness().
highp vec3 voxelLookup(highp vec3 direction, highp float smoothness) {
    highp float size = float(textureSize(voxelCube, 0).x), sphere = 0.5 * (size - 2.0); // without the guards
    highp float wanted = sphere * clamp(smoothness, 0.0, 1.0);
    highp float radius = min(sqrt(wanted * wanted + 1.0), sphere); // VoxelCube::centre_radius
    return textureLod(voxelCube, 0.5 + radius / size * direction, 0.0).rgb;
}
