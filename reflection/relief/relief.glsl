// First hits of rays on relief, on a GPU: GLSL ES 3.00 (WebGL 2), GLSL 3.30 and later. Include this file. The same data
// and algorithm as ExactTracer (exact_stream.cpp explains it), a ray a pixel, in single precision throughout: rays that
// graze the surface within its rounding (1e-6 of the depth) may pass it, or hit it.
//
// reliefDepths  ReliefTextures::depths as GL_R32F, reliefPlanes ReliefTextures::planes as GL_RGBA16UI; both NEAREST,
// reliefSize    and without mips; reliefSize, reliefLevels: the uniforms of the same names there
//
// Rays and hits are as relief_ray.h tells: texture coordinates, and depth from 0 at the polygon to 1.

uniform highp sampler2D reliefDepths;
uniform highp usampler2D reliefPlanes;
uniform highp ivec4 reliefSize;       // columns and rows of cells; 1: repeats, 0: clamps; levels
uniform highp ivec2 reliefLevels[16]; // first plane, columns

struct ReliefHit {
    bool found;
    highp float t;
    highp vec2 coordinate;
    highp float depth;
    highp vec2 slope; // per tile
    highp int reads;
};

struct ReliefSpan { // of a ray within a node or cell
    highp vec2 first, last;
    highp float end;
    bool leavesX;
};

ReliefSpan reliefSpan(highp vec2 first, highp vec2 last, highp vec2 entry, highp vec2 direction, highp vec2 perCell,
                      highp float t, highp float tLast) {
    highp vec2 border = vec2(direction.x >= 0.0 ? last.x : first.x, direction.y >= 0.0 ? last.y : first.y);
    highp vec2 crossing = (border - entry) * perCell;
    return ReliefSpan(first, last, max(t, min(min(crossing.x, crossing.y), tLast)), crossing.x <= crossing.y);
}

/// The cell at time t along one axis, or the next one across the span's border.
highp float reliefCell(highp float cell, highp float first, highp float last, highp float entry, highp float direction,
                       highp float t, bool crosses) {
    bool onwards = direction >= 0.0;
    if (crosses)
        return onwards ? last : first - 1.0;
    return clamp(floor(t * direction + entry), onwards ? cell : first, onwards ? last - 1.0 : cell);
}

/// The level whose nodes are as wide as a length in cells, or half of it.
highp int reliefLevel(highp float cells) {
    return max((floatBitsToInt(max(cells, 0.0)) >> 23) - 127, 0);
}

highp float reliefPowerOfTwo(highp int exponent) {
    return intBitsToFloat((exponent + 127) << 23);
}

/// The plane's depth at the node's middle, its slopes a cell, and how much deeper the surface may be.
highp vec4 reliefPlane(highp int index, highp int level) {
    highp int width = textureSize(reliefPlanes, 0).x;
    highp ivec4 plane = ivec4(texelFetch(reliefPlanes, ivec2(index % width, index / width), 0));
    highp vec2 slope = vec2((plane.xy ^ 0x8000) - 0x8000) * reliefPowerOfTwo(-14 - level);
    return vec4(slope, float(plane.z) / 65536.0, float(plane.w) / 16384.0);
}

ReliefHit reliefTrace(highp vec3 origin, highp vec3 direction, highp float tMost) {
    ReliefHit hit = ReliefHit(false, 0.0, vec2(0.0), 0.0, vec2(0.0), 0);
    bool repeats = reliefSize.z == 1;
    highp vec2 cells = vec2(reliefSize.xy), size = repeats ? cells : cells - 1.0;
    highp int top = reliefSize.w - 1;
    if (!all(lessThan(abs(origin), vec3(1e18))) || !all(lessThan(abs(direction), vec3(1e18))) || !(tMost >= 0.0))
        return hit;
    if (repeats)
        origin.xy -= floor(origin.xy);

    // The part that may hit something; times count from its beginning.
    highp float tFirst = 0.0, tLast = tMost;
    if (origin.z < 0.0) {
        if (!(direction.z > 0.0))
            return hit;
        tFirst = -origin.z / direction.z;
    }
    if (direction.z > 0.0)
        tLast = min(tLast, max((1.125 - origin.z) / direction.z, tFirst));
    if (direction.z < 0.0)
        tLast = min(tLast, max(0.0, -origin.z / direction.z));
    highp float tiles = max(abs(direction.x), abs(direction.y));
    if (tiles > 0.0)
        tLast = min(tLast, tFirst + 1024.0 / tiles);
    else if (direction.z == 0.0)
        tLast = min(tLast, 0.0);
    if (!(tFirst <= tLast))
        return hit;
    tLast -= tFirst;

    // In cells, from the corner of the cell of entry.
    highp vec2 entry = (origin.xy + tFirst * direction.xy) * size + (repeats ? -0.5 : 0.5);
    highp ivec2 corner = ivec2(floor(entry));
    entry -= floor(entry);
    highp float depth = origin.z + tFirst * direction.z;
    highp vec3 d = vec3(direction.xy * size, direction.z);
    highp float slight = 1e-12 * max(max(abs(d.x), abs(d.y)), abs(d.z));
    if (abs(d.x) <= slight)
        d.x = 0.0;
    if (abs(d.y) <= slight)
        d.y = 0.0;
    highp vec2 perCell = vec2(d.x == 0.0 ? 1e30 : 1.0 / d.x, d.y == 0.0 ? 1e30 : 1.0 / d.y);
    highp float speed = max(abs(d.x), abs(d.y)), t = 0.0;
    highp vec2 cell = vec2(0.0);
    highp int level = clamp(d.z > 0.0 ? reliefLevel(0.7 * speed / d.z) : 0, min(1, top), top);

    for (highp int n = 0; n < 1048576; ++n) {
        highp ivec2 at = corner + ivec2(cell);
        if (repeats)
            at -= reliefSize.xy * ivec2(floor((vec2(at) + 0.5) / cells));
        else if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, reliefSize.xy)))
            level = 0;
        ++hit.reads;

        if (level > 0) { // a node: does the ray stay above its plane?
            highp ivec2 node = ivec2(at.x >> level, at.y >> level);
            highp float side = float(1 << level);
            highp vec2 from = vec2(node) * side, first = cell - (vec2(at) - from);
            ReliefSpan span = reliefSpan(first, first + min(vec2(side), cells - from), entry, d.xy, perCell, t, tLast);
            highp vec4 plane = reliefPlane(reliefLevels[level].x + node.y * reliefLevels[level].y + node.x, level);
            highp vec2 uv = t * d.xy + (entry - (first + 0.5 * side));
            highp float misplaced = (1.0 + span.end * speed) * 4.76837158e-7;
            highp float error = (abs(plane.x) + abs(plane.y)) * misplaced + 9.53674316e-7;
            highp float sinking = d.z - dot(plane.xy, d.xy);
            highp float below = (t * d.z + depth - plane.z) - dot(plane.xy, uv);
            highp float belowOut = below + (span.end - t) * sinking;
            highp float rate = max(max(sinking, 1e-30), speed / 4096.0);
            if (max(below, belowOut) < -error) {
                if (span.end >= tLast)
                    return hit;
                cell.x = reliefCell(cell.x, span.first.x, span.last.x, entry.x, d.x, span.end, span.leavesX);
                cell.y = reliefCell(cell.y, span.first.y, span.last.y, entry.y, d.y, span.end, !span.leavesX);
                t = span.end;
                level = min(min(level + 1, top), reliefLevel((0.25 * plane.w - belowOut) / rate * speed * 1.4));
            } else {
                highp float dive = min(t + max(-(below + error), 0.0) / rate, span.end);
                highp float inSlab = min(t + (plane.w - below) / rate, span.end) - dive;
                cell.x = reliefCell(cell.x, span.first.x, span.last.x, entry.x, d.x, dive, false);
                cell.y = reliefCell(cell.y, span.first.y, span.last.y, entry.y, d.y, dive, false);
                t = dive;
                level = min(level - 1, reliefLevel(inSlab * speed * 2.0));
            }
            continue;
        }

        // A cell. Where a clamped tile has ended, its border's cells go on for ever.
        highp vec2 first = cell, last = cell + 1.0;
        if (!repeats) {
            highp vec2 low = vec2(lessThan(at, ivec2(0))), high = vec2(greaterThanEqual(at, reliefSize.xy));
            first = mix(mix(first, cells - vec2(corner), high), vec2(-4194304.0), low);
            last = mix(mix(last, vec2(4194304.0), high), vec2(-corner), low);
            at = clamp(at, ivec2(0), reliefSize.xy - 1);
        }
        ReliefSpan span = reliefSpan(first, last, entry, d.xy, perCell, t, tLast);
        highp float d00 = texelFetch(reliefDepths, at, 0).x, d10 = texelFetch(reliefDepths, at + ivec2(1, 0), 0).x,
                    d01 = texelFetch(reliefDepths, at + ivec2(0, 1), 0).x,
                    d11 = texelFetch(reliefDepths, at + ivec2(1, 1), 0).x;
        highp float du = d10 - d00, dv = d01 - d00, duv = (d11 - d01) - du;
        // The ray's depth below the surface: a s² + b s + c, s = time from t.
        highp vec2 uv = t * d.xy + (entry - cell);
        highp float c = (t * d.z + depth) - (d00 + du * uv.x + (dv + duv * uv.x) * uv.y);
        highp float b = d.z - (dv + duv * uv.x) * d.y - (du + duv * uv.y) * d.x, a = -duv * d.x * d.y;
        highp float square = b * b - 4.0 * a * c, root = sqrt(max(square, 0.0)), rest = span.end - t;
        highp float over = b >= 0.0 ? -2.0 * c : root - b, divisor = b >= 0.0 ? root + b : a + a;
        highp float s = rest, atEnd = c + rest * (b + rest * a);
        bool found = atEnd >= 0.0;
        if (square >= 0.0 && divisor > 0.0 && over <= rest * divisor) {
            s = over / divisor;
            found = true;
        }
        if (c >= 0.0) {
            s = 0.0;
            found = true;
        }
        if (found) {
            uv = clamp((t + s) * d.xy + (entry - cell), 0.0, 1.0);
            hit.found = true;
            hit.t = tFirst + (t + s);
            hit.coordinate = (vec2(at) + uv + (repeats ? 0.5 : -0.5)) / size;
            if (repeats)
                hit.coordinate -= floor(hit.coordinate);
            else
                hit.coordinate = (vec2(corner) + (t + s) * d.xy + entry - 0.5) / size;
            hit.depth = d00 + du * uv.x + (dv + duv * uv.x) * uv.y;
            hit.slope = vec2(du + duv * uv.y, dv + duv * uv.x) * size;
            return hit;
        }
        if (span.end >= tLast)
            return hit;
        cell.x = reliefCell(cell.x, first.x, last.x, entry.x, d.x, span.end, span.leavesX);
        cell.y = reliefCell(cell.y, first.y, last.y, entry.y, d.y, span.end, !span.leavesX);
        t = span.end;
        level = -atEnd * speed * 0.7 >= b + 2.0 * a * rest ? min(1, top) : 0;
    }
    return hit;
}
