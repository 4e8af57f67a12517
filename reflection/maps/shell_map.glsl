// ShellMap's lookup on a GPU: GLSL ES 3.00 (WebGL 2), GLSL 3.30 and later. Prepend, then include this file:
//
//   #define SHELL_COUNT n      shells of the map, at most 256
//   #define SHELL_CUBIC 0/1    TexelFilter
//   #define SHELL_GGX 0/1      LobeKind
//
// shellAtlas    atlas_image() of shell_atlas.h as GL_RGB16F, GL_RGB9_E5 or GL_RGB32F, row 0 first, filtered LINEAR,
//               without mips, CLAMP_TO_EDGE
// shells        shell_uniforms(): x, y, resolution, width
// shellSpacing  ShellMap::first_power(), ShellMap::shells_a_power()

uniform highp sampler2D shellAtlas;
uniform highp vec4 shells[SHELL_COUNT];
uniform highp vec2 shellSpacing;

/// face_place() of face_chart.h: x, y = u, v; z = face.
highp vec3 shellPlace(highp vec3 d) {
    highp vec3 a = abs(d);
    bool isX = a.x >= a.y && a.x >= a.z, isY = !isX && a.y >= a.z;
    highp float signed_ = isX ? d.x : isY ? d.y : d.z, major = abs(signed_), s = signed_ < 0.0 ? -1.0 : 1.0;
    highp vec2 uv = isX ? vec2(-s * d.z, -d.y) : isY ? vec2(d.x, s * d.z) : vec2(s * d.x, -d.y);
    highp float face = (isX ? 0.0 : isY ? 2.0 : 4.0) + (s < 0.0 ? 1.0 : 0.0);
    return vec3(1.2732395447351628 * atan(uv / major), face);
}

/// One shell at a place.
highp vec3 shellTexels(highp vec4 shell, highp vec3 place) {
    highp float border = float(SHELL_CUBIC), edge = shell.z + 2.0 * border;
    highp float column = floor(0.5 * place.z), row = place.z - 2.0 * column;
    highp vec2 size = vec2(textureSize(shellAtlas, 0));
    highp vec2 firstTexel = shell.xy + edge * vec2(column, row) + border + 0.5;
    highp vec2 at = 0.5 * (shell.z - 1.0) * (clamp(place.xy, -1.0, 1.0) + 1.0);
#if SHELL_CUBIC
    // The four texels of each axis in two bilinear reads (Sigg and Hadwiger, GPU Gems 2, chapter 20).
    highp vec2 cell = min(floor(at), shell.z - 2.0), f = at - cell, g = 1.0 - f;
    highp vec2 w0 = g * g * g / 6.0, w3 = f * f * f / 6.0;
    highp vec2 w1 = 2.0 / 3.0 + f * f * (0.5 * f - 1.0), w2 = 2.0 / 3.0 + g * g * (0.5 * g - 1.0);
    highp vec2 low = w0 + w1, high = w2 + w3;
    highp vec2 a = (firstTexel + cell - 1.0 + w1 / low) / size, b = (firstTexel + cell + 1.0 + w3 / high) / size;
    return low.y * (low.x * textureLod(shellAtlas, a, 0.0).rgb +
                    high.x * textureLod(shellAtlas, vec2(b.x, a.y), 0.0).rgb) +
           high.y * (low.x * textureLod(shellAtlas, vec2(a.x, b.y), 0.0).rgb +
                     high.x * textureLod(shellAtlas, b, 0.0).rgb);
#else
    return textureLod(shellAtlas, (firstTexel + at) / size, 0.0).rgb;
#endif
}

/// Filtered radiance in a direction (unit); parameter: Phong's exponent, or glTF's roughness.
highp vec3 shellLookup(highp vec3 direction, highp float parameter) {
#if SHELL_GGX
    highp float width = parameter * parameter;
#else
    highp float width = inversesqrt(parameter + 1.0);
#endif
    width = clamp(width, shells[SHELL_COUNT - 1].w, shells[0].w);
    highp vec3 place = shellPlace(direction);
    highp float position = (shellSpacing.x - pow(width, 0.2)) * shellSpacing.y;
    int index = clamp(int(position), 0, max(SHELL_COUNT - 2, 0)), next = min(index + 1, SHELL_COUNT - 1);
    highp float span = max(shells[index].w - shells[next].w, 1e-30);
    highp float share = clamp((shells[index].w - width) / span, 0.0, 1.0);
    return max(mix(shellTexels(shells[index], place), shellTexels(shells[next], place), share), 0.0);
}
