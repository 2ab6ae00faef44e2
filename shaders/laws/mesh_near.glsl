// L6: the triangles that a move may come close to, out of the tree. A search goes on in pieces: runs of triangles are
// collected until there is no room for more, looked at, and so on.

const uint kMeshStack = 145u; // 3 siblings a node of the longest path to a leaf, and the root
const uint kRuns = 16u;
#ifdef FS_F64
const real kSteep = real(1e30LF);
#else
const real kSteep = real(1e15LF);
#endif
const real kBoxMargin = kCorner + real(9.5367431640625e-07LF); // 2^-20

uint stack[kMeshStack];
uint runs[kRuns]; // as leaves are written
uint stack_height;
uint run_count;

real steepness(real way) {
    precise real inverse = ONE / way;
    precise real steep = abs(way) * kSteep;
    return steep > ONE ? inverse : kSteep;
}

real4 lesser(real4 one, real4 other) {
    return mix(one, other, lessThan(other, one));
}

real4 greater(real4 one, real4 other) {
    return mix(one, other, greaterThan(other, one));
}

// The interval of times at which a move is between two bounds.
void clip(real4 low, real4 high, real from, real inverse, inout real4 begin, inout real4 end) {
    precise real4 one = (low - real4(kBoxMargin + from)) * real4(inverse);
    precise real4 other = (high + real4(kBoxMargin - from)) * real4(inverse);
    begin = greater(begin, lesser(one, other));
    end = lesser(end, greater(one, other));
}

void begin_search() {
    stack[0] = 0u;
    stack_height = 1u;
    run_count = 0u;
}

// Goes on until the runs are full or the tree is done.
void search_on(Move move) {
    real3 inverse = real3(steepness(move.way.x), steepness(move.way.y), steepness(move.way.z));
    bool going = stack_height > 0u && run_count + kMeshChildren <= kRuns;
    [[dont_unroll]] do {
        if (going) {
            MeshNode4 node = nodes[stack[--stack_height]];
            real4 begin = real4(ZERO);
            real4 end = real4(move.until);
            clip(real4(node.low_x), real4(node.high_x), move.from.x, inverse.x, begin, end);
            clip(real4(node.low_y), real4(node.high_y), move.from.y, inverse.y, begin, end);
            clip(real4(node.low_z), real4(node.high_z), move.from.z, inverse.z, begin, end);
            [[unroll]] for (uint i = 0u; i < kMeshChildren; ++i)
                if (node.child[i] != kMeshNoChild && begin[i] <= end[i]) {
                    if ((node.child[i] & kMeshLeaf) == 0u)
                        stack[stack_height++] = node.child[i];
                    else
                        runs[run_count++] = node.child[i];
                }
        }
        ++spent;
        going = going && stack_height > 0u && run_count + kMeshChildren <= kRuns && spent < spent_limit;
    } while (going);
    if (stack_height > 0u && spent >= spent_limit)
        overrun = true;
}

bool search_goes_on() {
    return stack_height > 0u && !overrun;
}

// Goes through the triangles of the runs that were collected.
struct RunCursor {
    uint run;
    uint next;
    uint end;
};

RunCursor first_of_runs() {
    return RunCursor(0u, 0u, 0u);
}

// The next triangle; false if there is none, and then the runs are empty.
bool next_of_runs(inout RunCursor cursor, out uint triangle) {
    if (cursor.next == cursor.end && cursor.run < run_count) {
        uint leaf = runs[cursor.run++];
        cursor.next = (leaf & ~kMeshLeaf) / kMeshLeafTriangles;
        cursor.end = cursor.next + leaf % kMeshLeafTriangles + 1u;
    }
    bool found = cursor.next < cursor.end;
    triangle = found ? cursor.next : 0u;
    if (found)
        ++cursor.next;
    else
        run_count = 0u;
    return found;
}

real4 beyond(real4 low, real4 high, real at) {
    precise real4 below = low - at;
    precise real4 above = at - high;
    return greater(greater(below, above), real4(ZERO));
}

// How far each of the four boxes of a node is from a place, squared.
real4 box_squares(MeshNode4 node, real3 place) {
    real4 x = beyond(real4(node.low_x), real4(node.high_x), place.x);
    real4 y = beyond(real4(node.low_y), real4(node.high_y), place.y);
    real4 z = beyond(real4(node.low_z), real4(node.high_z), place.z);
    precise real4 squares = x * x + y * y + z * z;
    return squares;
}

// A distance within which there is nothing about a place, up to half the mesh's frame: that of the
// nearest leaf's box, less what rounding and the skin make of it.
real free_reach(real3 place) {
    const real most = real(0.5LF);
    real nearest = most * most;
    stack[0] = 0u;
    stack_height = 1u;
    [[dont_unroll]] do {
        MeshNode4 node = nodes[stack[--stack_height]];
        real4 squares = box_squares(node, place);
        [[unroll]] for (uint i = 0u; i < kMeshChildren; ++i)
            if (node.child[i] != kMeshNoChild && squares[i] < nearest) {
                if ((node.child[i] & kMeshLeaf) == 0u)
                    stack[stack_height++] = node.child[i];
                else
                    nearest = squares[i];
            }
        ++spent;
    } while (stack_height > 0u && spent < spent_limit);
    precise real reach = sqrt(nearest) - real(2.0LF) * kBoxMargin;
    return stack_height == 0u && reach > ZERO ? reach : ZERO;
}
