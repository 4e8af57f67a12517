// Relief on a mesh, on a GPU: include after relief.glsl. The same data and algorithm as SurfaceRelief, in single
// precision: a ray that has reached the mesh goes on through the tetrahedra under its triangles.
//
// surfacePlaces, surfaceFrames, surfacePrisms: SurfaceTextures' textures of these names, NEAREST, without mips.
// A prism's texels: places of its corners, and bits (1: solid, 2: its corners run clockwise); neighbours across the
// sides over corners 01, 02, 12; texture coordinates of corners 0 and 1; of corner 2, and the whole tiles that were
// taken off; frames of its corners.

uniform highp sampler2D surfacePlaces, surfaceFrames;
uniform highp usampler2D surfacePrisms;

struct SurfaceHit {
    bool found;
    highp float distance;  // from the entry; where the ray left the shell if nothing was found
    highp uint prism;      // index of the triangle
    highp vec3 weights;    // of the prism's own corners
    highp vec2 uv;         // as the mesh's
    highp float depth;     // 0 .. strength
    highp float thickness; // of depth 1, metres; 0: the mesh itself was hit
    highp vec3 geometricNormal, shadingNormal;
    highp int reads, tetrahedra;
};

highp uvec4 surfacePrism(highp uint prism, int texel) {
    highp int index = int(prism) * 5 + texel, width = textureSize(surfacePrisms, 0).x;
    return texelFetch(surfacePrisms, ivec2(index % width, index / width), 0);
}
highp vec3 surfacePlace(highp uint place, int texel) {
    highp int index = int(place) * 2 + texel, width = textureSize(surfacePlaces, 0).x;
    return texelFetch(surfacePlaces, ivec2(index % width, index / width), 0).xyz;
}
highp vec3 surfaceFrame(highp uint frame, int texel) {
    highp int index = int(frame) * 3 + texel, width = textureSize(surfaceFrames, 0).x;
    return texelFetch(surfaceFrames, ivec2(index % width, index / width), 0).xyz;
}

// Corners of the tetrahedra: 0, 1, 2 on the mesh, 3, 4, 5 below.
const ivec4 surfaceCorners[3] = ivec4[3](ivec4(0, 1, 2, 5), ivec4(0, 1, 4, 5), ivec4(0, 3, 4, 5));
// Behind the face opposite to corner k of tetrahedron i, at [4 i + k]: (0 within, next, its corner opposite to the
// face), (1 side, which, its upper half), (2 outside), (3 bottom).
const ivec3 surfaceCrossings[12] =
    ivec3[12](ivec3(1, 2, 1), ivec3(1, 1, 1), ivec3(0, 1, 2), ivec3(2, 0, 0), ivec3(1, 2, 0), ivec3(0, 2, 1),
              ivec3(0, 0, 2), ivec3(1, 0, 1), ivec3(3, 0, 0), ivec3(0, 1, 1), ivec3(1, 1, 0), ivec3(1, 0, 0));
// Behind a side's lower and upper half, at [2 side + upper]: tetrahedron, its corner opposite to the face.
const ivec2 surfaceSideEntries[6] =
    ivec2[6](ivec2(2, 3), ivec2(1, 3), ivec2(2, 2), ivec2(0, 1), ivec2(1, 0), ivec2(0, 0));

highp vec3 surfaceTriangleNormal(highp uint prism) {
    highp uvec4 head = surfacePrism(prism, 0);
    highp vec3 o = surfacePlace(head.x, 0);
    highp vec3 n = cross(surfacePlace(head.y, 0) - o, surfacePlace(head.z, 0) - o);
    return (head.w & 2u) != 0u ? -n : n;
}

/// The smooth surface's normal, turned by the relief's slope (tangent_frames.h).
highp vec3 surfaceShadingNormal(highp uint prism, highp vec3 weights, highp vec2 slope, highp float thickness) {
    highp uvec3 frames = surfacePrism(prism, 4).xyz;
    highp vec3 u = vec3(0.0), v = vec3(0.0), n = vec3(0.0);
    bool hasTangents = true;
    for (int k = 0; k < 3; ++k) {
        highp vec3 alongU = surfaceFrame(frames[k], 0);
        hasTangents = hasTangents && any(notEqual(alongU, vec3(0.0)));
        u += weights[k] * alongU;
        v += weights[k] * surfaceFrame(frames[k], 1);
        n += weights[k] * surfaceFrame(frames[k], 2);
    }
    n = normalize(n);
    highp vec3 acrossV = cross(v, n), acrossU = cross(n, u);
    highp float area = dot(u, acrossV);
    if (!hasTangents || area == 0.0)
        return n;
    return normalize(n + thickness / area * (slope.x * acrossV + slope.y * acrossU));
}

/// Weights of the prism's corners at the point of its triangle that is nearest.
highp vec3 surfaceWeights(highp uint prism, highp vec3 point) {
    highp uvec4 head = surfacePrism(prism, 0);
    highp vec3 o = surfacePlace(head.x, 0), a = surfacePlace(head.y, 0) - o, b = surfacePlace(head.z, 0) - o;
    highp vec3 p = point - o, n = cross(a, b);
    highp float squared = dot(n, n);
    if (!(squared > 0.0))
        return vec3(1.0 / 3.0);
    highp vec3 w = vec3(0.0, dot(cross(p, b), n) / squared, dot(cross(a, p), n) / squared);
    w.x = 1.0 - w.y - w.z;
    w = clamp(w, 0.0, 1.0);
    return w / (w.x + w.y + w.z);
}

SurfaceHit surfaceSolidHit(SurfaceHit hit, highp vec3 entry, highp vec3 direction) {
    hit.found = true;
    hit.weights = surfaceWeights(hit.prism, entry + hit.distance * direction);
    highp vec4 uv01 = uintBitsToFloat(surfacePrism(hit.prism, 2)), uv2 = uintBitsToFloat(surfacePrism(hit.prism, 3));
    hit.uv = uv2.zw + hit.weights.x * uv01.xy + hit.weights.y * uv01.zw + hit.weights.z * uv2.xy;
    hit.shadingNormal = surfaceShadingNormal(hit.prism, hit.weights, vec2(0.0), 0.0);
    highp vec3 n = surfaceTriangleNormal(hit.prism);
    hit.geometricNormal = dot(n, n) > 0.0 ? normalize(n) : hit.shadingNormal;
    return hit;
}

/// A walk from `origin` on in tetrahedron `tetrahedron`, which it entered opposite to its corner `from` (4: it begins
/// within). direction: unit, metres. strength: of relief, > 0.
SurfaceHit surfaceWalk(highp vec3 origin, highp vec3 direction, highp uint prism, int tetrahedron, int from,
                       highp float strength) {
    SurfaceHit hit = SurfaceHit(false, 0.0, prism, vec3(0.0), vec2(0.0), 0.0, 0.0, vec3(0.0), vec3(0.0), 0, 0);
    highp float s = 0.0;
    for (highp int n = 0; n < 4096; ++n) {
        ++hit.tetrahedra;
        highp uvec4 head = surfacePrism(hit.prism, 0);
        highp vec4 uv01 = uintBitsToFloat(surfacePrism(hit.prism, 2)),
                   uv2 = uintBitsToFloat(surfacePrism(hit.prism, 3));
        highp vec2 uvs[3] = vec2[3](uv01.xy, uv01.zw, uv2.xy);
        ivec4 corners = surfaceCorners[tetrahedron];
        highp vec3 p[4];
        for (int i = 0; i < 4; ++i)
            p[i] = surfacePlace(head[corners[i] % 3], corners[i] / 3) - origin;
        // Weights of the corners are linear along the ray (shell_step.cpp).
        highp vec3 e1 = p[1] - p[0], e2 = p[2] - p[0], e3 = p[3] - p[0], gradients[4];
        gradients[1] = cross(e2, e3);
        gradients[2] = cross(e3, e1);
        gradients[3] = cross(e1, e2);
        highp float volume = dot(e1, gradients[1]);
        for (int i = 1; i < 4; ++i)
            gradients[i] /= volume;
        gradients[0] = -(gradients[1] + gradients[2] + gradients[3]);
        highp vec3 at = vec3(0.0), along = vec3(0.0), weights = vec3(0.0), weightsAlong = vec3(0.0);
        highp vec3 gradientU = vec3(0.0), gradientV = vec3(0.0), gradientDepth = vec3(0.0);
        highp float end = 1e30;
        int leaves = 0;
        for (int i = 0; i < 4; ++i) {
            int column = corners[i] % 3;
            highp float weight = (i == 0 ? 1.0 : 0.0) - dot(gradients[i], p[0]), change = dot(gradients[i], direction);
            highp vec3 value = vec3(uvs[column], corners[i] < 3 ? 0.0 : 1.0);
            at += weight * value;
            along += change * value;
            weights[column] += weight;
            weightsAlong[column] += change;
            gradientU += value.x * gradients[i];
            gradientV += value.y * gradients[i];
            gradientDepth += value.z * gradients[i];
            if (change < 0.0 && i != from && -weight / change < end) {
                end = -weight / change;
                leaves = i;
            }
        }
        if (end == 1e30) {
            end = s;
            leaves = from < 4 ? from : 0;
        }
        end = max(end, s);

        highp vec3 here = at + s * along;
        ReliefHit inside = reliefTrace(vec3(here.xy, here.z / strength), vec3(along.xy, along.z / strength), end - s);
        hit.reads += inside.reads;
        ivec3 crossing = surfaceCrossings[4 * tetrahedron + leaves];
        if (inside.found || crossing.x == 3) {
            hit.found = true;
            hit.distance = inside.found ? min(s + inside.t, end) : end;
            highp vec2 slope = inside.found ? inside.slope * strength : vec2(0.0);
            hit.depth = inside.found ? inside.depth * strength : strength;
            hit.weights = max(weights + hit.distance * weightsAlong, vec3(0.0));
            hit.weights /= hit.weights.x + hit.weights.y + hit.weights.z;
            hit.uv = uv2.zw + hit.weights.x * uvs[0] + hit.weights.y * uvs[1] + hit.weights.z * uvs[2];
            for (int k = 0; k < 3; ++k)
                hit.thickness += hit.weights[k] * distance(surfacePlace(head[k], 0), surfacePlace(head[k], 1));
            hit.geometricNormal = normalize(slope.x * gradientU + slope.y * gradientV - gradientDepth);
            hit.shadingNormal = surfaceShadingNormal(hit.prism, hit.weights, slope, hit.thickness);
            return hit;
        }
        s = hit.distance = end;
        if (crossing.x == 2)
            return hit;
        if (crossing.x == 0) {
            tetrahedron = crossing.y;
            from = crossing.z;
            continue;
        }
        highp uint neighbor = surfacePrism(hit.prism, 1)[crossing.y];
        if (neighbor == 0xffffffffu)
            return hit;
        hit.prism = neighbor >> 2;
        ivec2 entry = surfaceSideEntries[2 * int(neighbor & 3u) + crossing.z];
        tetrahedron = entry.x;
        from = entry.y;
        if ((surfacePrism(hit.prism, 0).w & 1u) != 0u)
            return surfaceSolidHit(hit, origin, direction);
    }
    return hit;
}

/// A ray that has reached the outside of the mesh at `entry`, on a triangle. Distances count from there.
SurfaceHit surfaceTrace(highp vec3 entry, highp vec3 direction, highp uint triangle, highp float strength) {
    bool solid = (surfacePrism(triangle, 0).w & 1u) != 0u;
    if (solid || !(strength > 0.0) || !(dot(surfaceTriangleNormal(triangle), direction) < 0.0))
        return surfaceSolidHit(
            SurfaceHit(false, 0.0, triangle, vec3(0.0), vec2(0.0), 0.0, 0.0, vec3(0.0), vec3(0.0), 0, 0), entry,
            direction);
    return surfaceWalk(entry, direction, triangle, 0, 3, strength);
}

/// From a hit of surfaceTrace towards a light (unit): true where relief hides it; else `wayOut` from the hit, the ray
/// leaves the shell.
bool surfaceOccluded(SurfaceHit hit, highp vec3 toLight, highp float strength, out highp float wayOut) {
    wayOut = 0.0;
    highp uvec4 head = surfacePrism(hit.prism, 0);
    if (!(hit.thickness > 0.0))
        return dot(hit.geometricNormal, toLight) <= 0.0;
    highp float depth = hit.depth - 1e-4 * strength, rest = depth - hit.weights.z;
    highp vec3 bottom =
        vec3(max(rest - hit.weights.y, 0.0), clamp(rest, 0.0, hit.weights.y), min(depth, hit.weights.z));
    highp vec3 origin = vec3(0.0);
    for (int k = 0; k < 3; ++k)
        origin += (hit.weights[k] - bottom[k]) * surfacePlace(head[k], 0) + bottom[k] * surfacePlace(head[k], 1);
    SurfaceHit behind = surfaceWalk(origin, toLight, hit.prism,
                                    rest <= 0.0             ? 0
                                    : rest <= hit.weights.y ? 1
                                                            : 2,
                                    4, strength);
    wayOut = behind.distance;
    return behind.found;
}
