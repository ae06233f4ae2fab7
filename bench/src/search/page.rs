//! What was found as Markdown.

use super::tool::Hunted;
use super::{Answer, Question};
use std::fmt::{Error, Write};

/// The page below its title.
///
/// # Errors
/// None that a text could have.
pub fn page(tools: &[Hunted]) -> Result<String, Error> {
    let mut page = String::from("## The worst of all tools\n\n");
    writeln!(
        page,
        "| question | in | worst of the seeds | worst found | bar | tool |\n|---|---|--:|--:|--:|---|"
    )?;
    for question in Question::ALL {
        let all = tools.iter().filter_map(|tool| Some((tool, tool.of(*question)?)));
        // Where bars differ, the worst by its bar.
        let share = |answer: &Answer| answer.find.error / answer.bar.unwrap_or(1.0).max(1e-300);
        let Some((tool, worst)) = all.max_by(|a, b| share(a.1).total_cmp(&share(b.1))) else {
            continue;
        };
        writeln!(
            page,
            "| {} | {} | {} | {} | {} | {} |",
            question.name(),
            question.unit(),
            figure(worst.seeds),
            figure(worst.find.error),
            worst.bar.map_or_else(String::new, figure),
            tool.name
        )?;
    }
    forms(&mut page, tools)?;
    each(&mut page, tools)?;
    places(&mut page, tools)?;
    writeln!(page, "\n## Missed\n")?;
    let missed = missed(tools);
    if missed.is_empty() {
        page += "Nothing.\n";
    }
    for line in missed {
        writeln!(page, "- {line}")?;
    }
    Ok(page)
}

/// What is more than it may be.
pub fn missed(tools: &[Hunted]) -> Vec<String> {
    let line = |tool: &Hunted, answer: &Answer| {
        let bar = answer.bar.unwrap_or(f64::NAN);
        let (name, error) = (answer.question.name(), answer.find.error);
        format!("{}, {name}: {error:?} > {bar:?}, {}", tool.name, answer.find.at)
    };
    let mut missed: Vec<String> = tools
        .iter()
        .flat_map(|tool| tool.answers.iter().filter(|a| a.missed()).map(move |a| line(tool, a)))
        .collect();
    for tool in tools {
        missed.extend(tool.unlike.iter().take(1).map(|find| {
            format!(
                "{}: forms differ at {} points, first {}",
                tool.name,
                tool.unlike.len(),
                find.at
            )
        }));
    }
    missed
}

fn forms(page: &mut String, tools: &[Hunted]) -> Result<(), Error> {
    let points: usize = tools.iter().map(|tool| tool.compared).sum();
    let unlike: usize = tools.iter().map(|tool| tool.unlike.len()).sum();
    let levels = super::asked::levels().len();
    writeln!(
        page,
        "\nOf the {points} points that were asked about, at three lengths of the unit each, {unlike} have other bits in one form than in \
         another: code for one point, code for lanes at {levels} levels of this machine (some are the same), the interpreter."
    )
}

/// A row a tool: found, and the worst of the seeds.
fn each(page: &mut String, tools: &[Hunted]) -> Result<(), Error> {
    for half in Question::ALL.chunks(Question::ALL.len().div_ceil(2)) {
        writeln!(page, "\n## {} to {}\n", half[0].name(), half[half.len() - 1].name())?;
        writeln!(page, "Found, and in brackets the worst of the seeds.\n")?;
        let heads = half.iter().map(|q| format!(" {} |", q.name())).collect::<String>();
        writeln!(page, "| tool |{heads}\n|---|{}", "--:|".repeat(half.len()))?;
        for tool in tools {
            write!(page, "| {} |", tool.name)?;
            for question in half {
                match tool.of(*question) {
                    Some(answer) => {
                        let bar = answer.bar.filter(|_| *question == Question::PushJump);
                        let bar =
                            bar.map_or_else(String::new, |bar| format!(" of {}", figure(bar)));
                        let [found, seeds] = [answer.find.error, answer.seeds].map(figure);
                        write!(page, " {found}{bar} ({seeds}) |")?;
                    }
                    None => write!(page, " |")?,
                }
            }
            writeln!(page)?;
        }
    }
    Ok(())
}

/// The places of the worst.
fn places(page: &mut String, tools: &[Hunted]) -> Result<(), Error> {
    writeln!(
        page,
        "\n## Where\n\nThe worst of each question, to the last bit, in the tool's frame and unit; poses are in mm.\n"
    )?;
    for question in Question::ALL {
        let all = tools.iter().filter_map(|tool| Some((tool, tool.of(*question)?)));
        let worst = all.max_by(|a, b| a.1.find.error.total_cmp(&b.1.find.error));
        if let Some((tool, answer)) = worst.filter(|(_, answer)| !answer.find.at.is_empty()) {
            let error = figure(answer.find.error);
            writeln!(
                page,
                "- {}, {error} {}: {}, {}",
                question.name(),
                question.unit(),
                tool.name,
                answer.find.at
            )?;
        }
    }
    Ok(())
}

impl Hunted {
    /// The answer to a question, if it was asked.
    pub fn of(&self, question: Question) -> Option<&Answer> {
        self.answers.iter().find(|answer| answer.question == question)
    }
}

/// Three digits.
fn figure(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        size if !(1e-3..1e5).contains(&size) => format!("{value:.1e}"),
        _ => format!("{value:.3}"),
    }
}
