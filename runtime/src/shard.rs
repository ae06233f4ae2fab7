//! Shards: the equal parts of a work that several machines share.

use std::collections::BTreeMap;
use std::fmt;
use std::ops::Range;
use std::str::FromStr;

/// One of the equal parts of a work: `3/8` is the third of eight.
///
/// ```
/// use touchoff::Shard;
///
/// let shard: Shard = "3/8".parse()?;
/// assert_eq!((shard.number(), shard.count(), shard.range(16)), (3, 8, 4..6));
/// # Ok::<(), touchoff::NoShard>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Shard {
    number: u32,
    count: u32,
}

impl Shard {
    /// Largest number of shards.
    pub const MAX: u32 = 1_000_000;

    /// Returns the shard with a number from 1 to `count`; `None` if there is no such shard, or more than [`Shard::MAX`].
    pub fn new(number: u32, count: u32) -> Option<Shard> {
        (count <= Shard::MAX && (1..=count).contains(&number)).then_some(Shard { number, count })
    }

    /// Returns its number, from 1 on.
    pub fn number(self) -> u32 {
        self.number
    }

    /// Returns the number of shards.
    pub fn count(self) -> u32 {
        self.count
    }

    /// Returns its range of `total` items. Those of all shards are all items, each once; some shards of few items have none.
    pub fn range(self, total: usize) -> Range<usize> {
        let bound =
            |shards: u32| (u128::from(shards) * total as u128 / u128::from(self.count)) as usize;
        bound(self.number - 1)..bound(self.number)
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.count)
    }
}

/// The shards of a work that are there, each with the name of its file.
#[derive(Clone, Debug, Default)]
pub struct ShardSet {
    files: BTreeMap<Shard, String>,
    /// The shard that was added first.
    first: Option<Shard>,
}

/// A reason for which a shard is not added to others.
#[derive(Clone, PartialEq, Eq, thiserror::Error)]
pub enum ShardSetError {
    /// A shard of another number of shards.
    #[error(
        "{file} is shard {shard}, and {first} is one of {count}: run all shards with one number of them"
    )]
    OtherCount {
        /// The file.
        file: String,
        /// Its shard.
        shard: Shard,
        /// The first file.
        first: String,
        /// The number of its shards.
        count: u32,
    },
    /// Two files of one shard.
    #[error("{file} and {first} are both shard {shard}: give one of them")]
    Twice {
        /// The file.
        file: String,
        /// The file before.
        first: String,
        /// Their shard.
        shard: Shard,
    },
}

crate::debug_as_sentence!(ShardSetError);

impl ShardSet {
    /// Adds the shard of a file.
    ///
    /// # Errors
    /// If the shards before are of another number, or it is among them.
    pub fn add(&mut self, shard: Shard, file: &str) -> Result<(), ShardSetError> {
        let first = *self.first.get_or_insert(shard);
        let (file, name) = (file.to_owned(), |shard: &Shard| self.files[shard].clone());
        if first.count != shard.count {
            return Err(ShardSetError::OtherCount {
                file,
                shard,
                first: name(&first),
                count: first.count,
            });
        }
        if self.files.contains_key(&shard) {
            return Err(ShardSetError::Twice { file, first: name(&shard), shard });
        }
        self.files.insert(shard, file);
        Ok(())
    }

    /// Returns the number of all shards; 0 without any, since nothing says how many there are.
    pub fn count(&self) -> u32 {
        self.first.map_or(0, Shard::count)
    }

    /// Returns the shards that are missing, in order; none without any.
    pub fn left(&self) -> impl Iterator<Item = Shard> + '_ {
        let shards = (1..=self.count()).map(|number| Shard { number, count: self.count() });
        shards.filter(|shard| !self.files.contains_key(shard))
    }
}

/// A text that is no shard.
#[derive(Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "give the number of a shard and that of all shards, such as 3/8, up to {} shards",
    Shard::MAX
)]
pub struct NoShard;

crate::debug_as_sentence!(NoShard);

impl FromStr for Shard {
    type Err = NoShard;

    fn from_str(text: &str) -> Result<Shard, NoShard> {
        let digits = |text: &str| {
            let is_number = !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
            text.parse().ok().filter(|_| is_number)
        };
        let (number, count) = text.split_once('/').ok_or(NoShard)?;
        let found = digits(number).zip(digits(count));
        found.and_then(|(number, count)| Shard::new(number, count)).ok_or(NoShard)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_shards_or_refused() {
        for text in [
            "",
            "/",
            "1",
            "0/3",
            "4/3",
            "1/0",
            "+1/3",
            "1/3/5",
            " 1/3",
            "-1/3",
            "1/1000001",
            "1.0/2",
        ] {
            assert!(text.parse::<Shard>().is_err(), "{text}");
        }
        for text in ["1/1", "3/8", "1000000/1000000"] {
            assert_eq!(text.parse::<Shard>().expect("a shard").to_string(), text);
        }
    }

    #[test]
    fn each_item_is_in_one_shard() {
        for (count, total) in (1..12).flat_map(|count| [0, 1, 5, 100].map(|total| (count, total))) {
            let shards = || (1..=count).map(|number| Shard::new(number, count).expect("a shard"));
            let ranges: Vec<usize> = shards().flat_map(|shard| shard.range(total)).collect();
            assert_eq!(ranges, (0..total).collect::<Vec<_>>());
        }
        let all = Shard::new(1_000_000, 1_000_000).expect("a shard");
        assert_eq!(all.range(usize::MAX).end, usize::MAX);
    }

    #[test]
    fn a_set_has_each_shard_once() {
        let shard = |text: &str| text.parse::<Shard>().expect("a shard");
        let left = |set: &ShardSet| set.left().map(|shard| shard.to_string()).collect::<Vec<_>>();
        let mut set = ShardSet::default();
        assert_eq!((set.count(), left(&set)), (0, Vec::new()));
        set.add(shard("2/3"), "b").expect("a shard");
        assert_eq!((set.count(), left(&set)), (3, vec!["1/3".to_owned(), "3/3".to_owned()]));
        let twice = set.add(shard("2/3"), "c").expect_err("twice").to_string();
        assert!(twice.starts_with("c and b are both shard 2/3"), "{twice}");
        let other = set.add(shard("1/4"), "d").expect_err("another number").to_string();
        assert!(other.starts_with("d is shard 1/4, and b is one of 3"), "{other}");
        set.add(shard("3/3"), "e").expect("a shard");
        set.add(shard("1/3"), "f").expect("a shard");
        assert!(left(&set).is_empty());
    }
}
