//! Half-edges of a triangle list, as arrays: half-edge 3 t + k goes from corner k of triangle t to
//! the next corner.

/// No twin: a boundary.
pub(crate) const NONE: u32 = u32::MAX;

/// Start and end point of a half-edge.
pub(crate) fn ends(triangles: &[[u32; 3]], half_edge: u32) -> (u32, u32) {
    let triangle = &triangles[half_edge as usize / 3];
    let k = half_edge as usize % 3;
    (triangle[k], triangle[(k + 1) % 3])
}

/// The next half-edge of the same triangle.
pub(crate) fn next(half_edge: u32) -> u32 {
    if half_edge % 3 == 2 {
        half_edge - 2
    } else {
        half_edge + 1
    }
}

/// The half-edges of every point, grouped: those that leave or enter point p with p the smaller
/// end are `list[start[p] .. start[p + 1]]`, ordered by the larger end.
pub(crate) struct Edges {
    start: Vec<u32>,
    list: Vec<(u32, u32)>,
}

impl Edges {
    /// Sorts the half-edges into buckets by their smaller end, without hashing.
    pub fn new(triangles: &[[u32; 3]], points: usize) -> Self {
        let count = 3 * triangles.len() as u32;
        let smaller = |e: u32| {
            let (a, b) = ends(triangles, e);
            a.min(b) as usize
        };
        let mut start = vec![0u32; points + 1];
        for e in 0..count {
            start[smaller(e) + 1] += 1;
        }
        for p in 0..points {
            start[p + 1] += start[p];
        }
        let mut at = start.clone();
        let mut list = vec![(0, 0); count as usize];
        for e in 0..count {
            let (a, b) = ends(triangles, e);
            let slot = &mut at[smaller(e)];
            list[*slot as usize] = (a.max(b), e);
            *slot += 1;
        }
        for p in 0..points {
            list[start[p] as usize..start[p + 1] as usize].sort_unstable();
        }
        Self { start, list }
    }

    /// All edges, each as its smaller end, its larger end and its half-edges.
    pub fn groups(&self) -> impl Iterator<Item = (u32, u32, &[(u32, u32)])> {
        (0..self.start.len() - 1).flat_map(move |p| {
            self.list[self.start[p] as usize..self.start[p + 1] as usize]
                .chunk_by(|a, b| a.0 == b.0)
                .map(move |group| (p as u32, group[0].0, group))
        })
    }

    /// The other half-edge of each edge that exactly two triangles share, whatever their winding.
    pub fn twins(&self) -> Vec<u32> {
        let mut twins = vec![NONE; self.list.len()];
        for (_, _, group) in self.groups() {
            if let [(_, e), (_, f)] = *group {
                twins[e as usize] = f;
                twins[f as usize] = e;
            }
        }
        twins
    }
}

/// The half-edges that leave each point: those of point p are `list[start[p] .. start[p + 1]]`.
pub(crate) struct Fans {
    start: Vec<u32>,
    list: Vec<u32>,
}

impl Fans {
    /// Sorts the half-edges into buckets by their origin.
    pub fn new(triangles: &[[u32; 3]], points: usize) -> Self {
        let mut start = vec![0u32; points + 1];
        for &p in triangles.iter().flatten() {
            start[p as usize] += 1;
        }
        let mut sum = 0;
        for s in &mut start {
            sum += *s;
            *s = sum;
        }
        // Filled from the back, the ends of the buckets become their starts.
        let mut list = vec![0; 3 * triangles.len()];
        for e in (0..list.len() as u32).rev() {
            let slot = &mut start[ends(triangles, e).0 as usize];
            *slot -= 1;
            list[*slot as usize] = e;
        }
        Self { start, list }
    }

    /// The half-edges that leave a point.
    pub fn of(&self, p: u32) -> &[u32] {
        &self.list[self.start[p as usize] as usize..self.start[p as usize + 1] as usize]
    }

    /// The opposite half-edge of a half-edge of a consistently wound manifold, or [`NONE`].
    pub fn twin(&self, triangles: &[[u32; 3]], e: u32) -> u32 {
        let (a, b) = ends(triangles, e);
        let back = |&&f: &&u32| ends(triangles, f).1 == a;
        self.of(b).iter().find(back).copied().unwrap_or(NONE)
    }

    /// The opposite half-edges of all.
    pub fn twins(&self, triangles: &[[u32; 3]]) -> Vec<u32> {
        (0..3 * triangles.len() as u32)
            .map(|e| self.twin(triangles, e))
            .collect()
    }
}

/// Number of half-edges that a walk around a point can take at most, as a bound for its loop.
pub(crate) const MOST_AROUND: usize = 1 << 20;
