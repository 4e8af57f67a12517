// HorizonTable's lookup on a GPU: GLSL ES 3.00 (WebGL 2), GLSL 3.30 and later. Prepend, then include this file:
//
//   #define HORIZON_GGX 0/1    LobeKind
//
// horizonTable  HorizonTable::cells() as GL_RGBA32F (or GL_RGBA16F), columns x rows, row 0 first, filtered NEAREST
//
// Radiance = share x half the sum of the map's lookups at (first, parameter) and (second, parameter); where first and
// second are the same, one lookup will do.

uniform highp sampler2D horizonTable;

struct HorizonLookup {
    highp vec3 first, second;
    highp float parameter, share;
};

/// normal, mirrored: unit. parameter: Phong's exponent, or glTF's roughness.
HorizonLookup horizonLookup(highp vec3 normal, highp vec3 mirrored, highp float parameter) {
    highp float cosine = dot(normal, mirrored);
    highp vec3 across = normal - cosine * mirrored;
    highp float sine = length(across);
    if (!(sine > 1e-5))
        return HorizonLookup(mirrored, mirrored, parameter, cosine > 0.0 ? 1.0 : 0.0);
#if HORIZON_GGX
    highp float width = parameter * parameter, narrowest = 1e-4;
#else
    highp float width = inversesqrt(parameter + 1.0), narrowest = 0.003;
#endif
    highp vec2 last = vec2(textureSize(horizonTable, 0)) - 1.0;
    highp float q = atan(cosine, sine) / width, end = 1.5707963267948966 / width;
    highp float t = q / (2.0 + abs(q)) * (2.0 + end) / end;
    highp vec2 at = clamp(vec2(0.5 * (1.0 + t), log(width) / log(narrowest)), 0.0, 1.0) * last;
    highp vec2 cell = min(floor(at), last - 1.0), f = at - cell;
    ivec2 i = ivec2(cell);
    highp vec4 here =
        mix(mix(texelFetch(horizonTable, i, 0), texelFetch(horizonTable, i + ivec2(1, 0), 0), f.x),
            mix(texelFetch(horizonTable, i + ivec2(0, 1), 0), texelFetch(horizonTable, i + ivec2(1, 1), 0), f.x), f.y);
    highp float turn = here.y * width, spread = here.z * width;
    highp vec3 mean = cos(turn) * mirrored + sin(turn) / sine * across;
    highp vec3 beside = here.z > 0.02 ? spread / sine * cross(normal, mirrored) : vec3(0.0);
#if HORIZON_GGX
    highp float narrower = parameter * sqrt(here.w);
#else
    highp float narrower = (parameter + 3.0) / here.w - 3.0;
#endif
    return HorizonLookup(normalize(mean + beside), normalize(mean - beside), narrower, here.x);
}
