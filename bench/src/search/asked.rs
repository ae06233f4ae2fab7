//! A tool that is asked point by point, and whether all its forms say the same.

use super::Find;
use touchoff::tool::{Ask, Felt, Interpreted, Points};
use touchoff::{Level, Tool};
use touchoff_tests::accuracy::bits;

/// Points after which all forms are asked.
const TRAIL: usize = 1 << 12;

/// Lengths of the file's unit in the part's.
const LENGTHS: [f64; 3] = [1.0, 25.4, 1e-3];

/// A tool, and all the points that it was asked about since its forms were compared.
pub struct Asked<'a> {
    /// The tool.
    pub tool: &'a dyn Tool,
    interpreted: &'a Interpreted,
    levels: Vec<Level>,
    one: Points,
    felt: Felt,
    trail: Points,
    /// How many points all forms were asked about, each at three lengths.
    pub compared: usize,
    /// Points at which two forms differ, and the first of them.
    pub unlike: Vec<Find>,
}

/// Every level of this machine, the one with the least vectors first.
pub fn levels() -> Vec<Level> {
    let best = Level::new();
    let mut levels = vec![Level::baseline(), best];
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    {
        levels.extend(best.as_sse2().map(Level::Sse2));
        levels.extend(best.as_sse4_2().map(Level::Sse4_2));
        levels.extend(best.as_avx2().map(Level::Avx2));
        levels.extend(best.as_avx512().map(Level::Avx512));
    }
    levels
}

impl<'a> Asked<'a> {
    /// A tool, compiled and interpreted.
    pub fn new(tool: &'a dyn Tool, interpreted: &'a Interpreted) -> Asked<'a> {
        Asked {
            tool,
            interpreted,
            levels: levels(),
            one: Points::default(),
            felt: Felt::default(),
            trail: Points::default(),
            compared: 0,
            unlike: Vec::new(),
        }
    }

    /// What is felt at a point: the first of the lists.
    pub fn at(&mut self, p: [f64; 3]) -> &Felt {
        self.one.clear();
        self.one.push(p);
        self.trail.push(p);
        if self.trail.len() == TRAIL {
            self.compare();
        }
        self.tool.evaluate(self.levels[0], Ask::EVERYTHING, &self.one, 1.0, &mut self.felt);
        &self.felt
    }

    /// The region that a point is put in; `None` outside.
    pub fn region(&mut self, p: [f64; 3]) -> Option<usize> {
        let felt = self.at(p);
        (felt.inside[0] & 1 == 1).then(|| felt.region[0] as usize)
    }

    /// Asks all forms about the points of the trail, and begins another.
    pub fn compare(&mut self) {
        let points = std::mem::take(&mut self.trail);
        for length in LENGTHS {
            let felt = |tool: &dyn Tool, level: Level| {
                let mut felt = Felt::default();
                tool.evaluate(level, Ask::EVERYTHING, &points, length, &mut felt);
                felt
            };
            let first = felt(self.tool, self.levels[0]);
            let forms = self.levels[1..].iter().map(|level| felt(self.tool, *level));
            let others: Vec<Felt> = forms.chain([felt(self.interpreted, Level::new())]).collect();
            for i in 0..points.len() {
                if let Some(form) =
                    others.iter().position(|other| bits(other, i) != bits(&first, i))
                {
                    let p = points.coordinates().map(|list| list[i]);
                    let at = format!("{p:?}, length {length}, form {}", form + 1);
                    self.unlike.push(Find { error: 1.0, at, points: vec![p] });
                }
            }
        }
        self.compared += points.len();
        self.trail = points;
        self.trail.clear();
    }
}
