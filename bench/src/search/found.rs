//! What was found, as lines of a file, so that it is asked again after every change.

use super::asked::Asked;
use super::tool::Hunted;
use super::{Question, borders, evaluator};
use touchoff_tests::accuracy::Judge;

/// A line: tool, question, error when it was found, bar, and one point or two neighbours.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// The tool.
    pub tool: String,
    /// What was asked.
    pub question: Question,
    /// How large the error was.
    pub error: f64,
    /// What it may be.
    pub bar: f64,
    /// Where.
    pub points: Vec<[f64; 3]>,
}

/// The lines of what was found at points and has a bar.
pub fn lines(hunted: &Hunted) -> Vec<Line> {
    let answers = hunted.answers.iter().filter_map(|answer| {
        let points = answer.find.points.clone();
        let (tool, question, error) = (hunted.name.clone(), answer.question, answer.find.error);
        (!points.is_empty()).then_some(Line { tool, question, error, bar: answer.bar?, points })
    });
    answers.collect()
}

impl Line {
    /// The line as text; every number comes back to the last bit.
    pub fn text(&self) -> String {
        let numbers =
            [self.error, self.bar].into_iter().chain(self.points.iter().flatten().copied());
        let numbers: Vec<String> = numbers.map(|number| format!("{number:?}")).collect();
        format!("{}\t{:?}\t{}", self.tool, self.question, numbers.join("\t"))
    }

    /// The line of a text; `None` if it is none.
    pub fn read(text: &str) -> Option<Line> {
        let mut words = text.split('\t');
        let tool = words.next()?.to_owned();
        let word = words.next()?;
        let question = *Question::ALL.iter().find(|question| format!("{question:?}") == word)?;
        let numbers = words.map(|word| word.parse().ok()).collect::<Option<Vec<f64>>>()?;
        let [error, bar, points @ ..] = numbers.as_slice() else { return None };
        let (points, rest) = points.as_chunks::<3>();
        let whole = rest.is_empty() && (1..=2).contains(&points.len());
        whole.then(|| Line { tool, question, error: *error, bar: *bar, points: points.to_vec() })
    }

    /// The error at the same place now.
    pub fn again(&self, asked: &mut Asked<'_>, judge: Option<&Judge<'_>>, ulp: f64) -> f64 {
        match (self.points.as_slice(), judge) {
            ([p], Some(judge)) => {
                let judged = judge.judge(*p, asked.at(*p), 0);
                evaluator::error(self.question, &judged)
            }
            ([a, b], judge) => borders::measured(self.question, [*a, *b], asked, judge, ulp),
            _ => f64::NAN,
        }
    }
}
