//! Words of Sinumerik that are passed over because they move nothing, and words that are refused, with the reason and a remedy.
//! `docs/controls.md` lists them from this table.

/// The use of a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Use {
    /// It neither moves the tool nor changes what positions mean, with its arguments, its index and its value.
    PassedOver,
    /// It is refused.
    Refused { meaning: &'static str, remedy: &'static str },
}

const MOTIONS: &str = "post the program with its motions";
const LINES: &str = "post the program with lines and arcs";
const NUMBERS: &str = "post the program with numbers";
const WITHOUT: &str = "check the program without it";

/// Words that are passed over.
const PASSED_OVER: &[&str] = &[
    // Acceleration, look-ahead and compression, all within tolerances of the control.
    "SOFT",
    "BRISK",
    "BRISKA",
    "SOFTA",
    "DRIVE",
    "FFWON",
    "FFWOF",
    "FNORM",
    "FLIN",
    "COMPOF",
    "COMPON",
    "COMPCURV",
    "COMPCAD",
    "COMPSURF",
    "CTOL",
    "OTOL",
    "ATOL",
    "CTOLG0",
    "OTOLG0",
    "STOLF",
    "ADIS",
    "ADISPOS",
    "DYNNORM",
    "DYNPOS",
    "DYNROUGH",
    "DYNSEMIFIN",
    "DYNFINISH",
    "DYNPREC",
    "CPRECON",
    "CPRECOF",
    "UPATH",
    "SPATH",
    "ACC",
    "VELOLIM",
    "JERKLIM",
    "ORISON",
    "ORISOF",
    "CYCLE832",
    "RTLION",
    "CP",
    // Feed and spindle.
    "CFC",
    "CFTCP",
    "CFIN",
    "FGROUP",
    "FGREF",
    "FL",
    "FRC",
    "FRCM",
    "FD",
    "FPRAON",
    "FPRAOF",
    "OVR",
    "OVRA",
    "OVRRAP",
    "LIMS",
    "SETMS",
    "FENDNORM",
    "FCUB",
    // Messages, the display, the order of blocks.
    "MSG",
    "WORKPIECE",
    "STOPRE",
    "STARTFIFO",
    "STOPFIFO",
    "SBLON",
    "SBLOF",
    "DISPLOF",
    "DISPLON",
    "DIAMOF",
    "GROUP_BEGIN",
    "GROUP_END",
    // Words for what is in force anyway.
    "NORM",
    "CUT2D",
    "CUT2DF",
    "WALIMON",
    "WALIMOF",
];

/// Words that are refused, by their meaning.
const REFUSED: &[(&[&str], &str, &str)] = &[
    (
        &["SCALE", "ASCALE", "MIRROR", "AMIRROR"],
        "scaling or mirroring",
        "post the program with final coordinates",
    ),
    (
        &[
            "ROTS", "AROTS", "CROTS", "TOFRAME", "TOFRAMEX", "TOFRAMEY", "TOFRAMEZ", "TOROT",
            "TOROTX", "TOROTY", "TOROTZ", "TOROTOF", "PAROT", "PAROTOF",
        ],
        "a rotation by solid angles, or by the axes of the machine",
        "write ROT with X, Y or Z, or CYCLE800",
    ),
    (
        &["CTRANS", "CROT", "CMIRROR", "CSCALE", "MEAFRAME", "PRESETON", "PRESETONS"],
        "a frame that is computed",
        "write TRANS and ROT",
    ),
    (
        &["TCARR", "TCOABS", "TCOFR", "TCOFRX", "TCOFRY", "TCOFRZ"],
        "a tool carrier",
        "write CYCLE800",
    ),
    (
        &["TRANSMIT", "TRACYL", "TRAANG", "TRACON", "TRAFOON"],
        "a transformation of another kinematics",
        "post the program with X Y Z A B C",
    ),
    (
        &[
            "CIP", "CT", "AR", "AP", "RP", "ANG", "INVCW", "INVCCW", "POLY", "ASPLINE", "BSPLINE",
            "CSPLINE",
        ],
        "another form of arc, of polar coordinates or of spline",
        LINES,
    ),
    (&["RNDM"], "rounded corners of all lines that follow", "write RND in each block"),
    (
        &[
            "DISC", "DISR", "DISCL", "KONT", "KONTC", "KONTT", "OFFN", "CUT3DC", "CUT3DCC",
            "CUT3DF", "CUT3DFF", "CUT3DFS", "CUT3DCD",
        ],
        "another form of cutter compensation",
        "post the program with the path of the tool",
    ),
    (&["CDON", "CDOF", "CDOF2"], "a check of collisions under cutter compensation", WITHOUT),
    (&["DIAMON", "DIAM90"], "diameter mode of a lathe", "post the program for a mill"),
    (
        &[
            "POS", "POSA", "POSP", "FA", "SPOSA", "OS", "GEOAX", "TANG", "TANGON", "TANGOF",
            "LEADON", "TRAILON",
        ],
        "a motion of an axis by itself",
        "write the axis in a block with G0 or G1",
    ),
    (&["ACP", "ACN"], "a direction of a rotary axis", "write its angle, in G90"),
    (
        &["PTP", "PTPG0", "RTLIOF"],
        "a path of each axis by itself",
        "remove it, or write CP or RTLION",
    ),
    (
        &[
            "ORIEULER",
            "ORIRPY",
            "ORIRPY2",
            "ORIPATH",
            "ORIPATHS",
            "ORICURVE",
            "ORICONCW",
            "ORICONCCW",
            "ORICONTO",
            "ORICONIO",
            "ORIROTA",
            "ORIROTR",
            "ORIROTT",
            "ORIROTC",
            "LEAD",
            "TILT",
            "THETA",
            "ORIRESET",
            "ORID",
            "ORIC",
        ],
        "another form of tool orientation",
        "write A3= B3= C3=, or rotary axes",
    ),
    (
        &[
            "CYCLE60", "CYCLE61", "CYCLE62", "CYCLE63", "CYCLE64", "CYCLE70", "CYCLE71", "CYCLE72",
            "CYCLE73", "CYCLE74", "CYCLE75", "CYCLE76", "CYCLE77", "CYCLE78", "CYCLE79", "CYCLE90",
            "CYCLE899", "CYCLE952", "POCKET1", "POCKET2", "POCKET3", "POCKET4", "SLOT1", "SLOT2",
            "LONGHOLE",
        ],
        "a milling cycle, whose path is the control's own",
        MOTIONS,
    ),
    (
        &["HOLES1", "HOLES2", "CYCLE801", "CYCLE802"],
        "a pattern of holes, whose order the control chooses",
        "write the position of each hole after MCALL",
    ),
    (&["CYCLE87", "CYCLE88"], "a boring cycle that stops the program", MOTIONS),
    (
        &[
            "MEAS",
            "MEAW",
            "MEASA",
            "CYCLE971",
            "CYCLE976",
            "CYCLE977",
            "CYCLE978",
            "CYCLE979",
            "CYCLE996",
            "CYCLE998",
            "CYCLE995",
            "CYCLE9960",
            "CYCLE982",
        ],
        "probing, whose end only the machine knows",
        WITHOUT,
    ),
    (
        &["PCALL", "ISOCALL"],
        "a call by a path, or in ISO mode",
        "call the subprogram by its name, and name its file in `subprograms` of the job",
    ),
    (
        &[
            "INIT", "START", "WAITE", "WAITM", "WAITP", "WAITS", "SETM", "CLEARM", "SETINT",
            "SETAL", "ISFILE", "READ", "WRITE", "DELETE", "GET", "GETD", "RELEASE", "WHEN",
            "WHENEVER", "DO", "ID", "IDS", "EVERY", "CANCEL", "DELDTG", "REPOSA", "REPOSL",
            "AXCTSWE", "STRLEN", "PUTFTOC", "FTOCON", "NEWCONF", "PUTFTOCF", "SYNFCT", "CORROF",
        ],
        "a statement about events, channels or files",
        WITHOUT,
    ),
    (
        &["DEFINE", "REDEF", "EXTERN", "SET", "REP", "GOTOSOF"],
        "a definition that changes the language",
        "write the program without it",
    ),
    (
        &["CTAB", "CTABDEF", "SPLINE", "AXIS", "FRAME", "CHAR"],
        "a table, or a type of variables",
        NUMBERS,
    ),
];

/// Returns the use of a word, in either case.
pub(super) fn use_of(word: &str) -> Option<Use> {
    if PASSED_OVER.iter().any(|known| word.eq_ignore_ascii_case(known)) {
        return Some(Use::PassedOver);
    }
    let contains = |words: &[&str]| words.iter().any(|known| word.eq_ignore_ascii_case(known));
    let (_, meaning, remedy) = REFUSED.iter().find(|(words, ..)| contains(words))?;
    Some(Use::Refused { meaning, remedy })
}

/// Returns whether a word is read, or is refused since it has an effect.
pub(in crate::gcode) fn has_effect(word: &str) -> bool {
    let is_statement = STATEMENTS.iter().any(|known| word.eq_ignore_ascii_case(known));
    is_statement || matches!(use_of(word), Some(Use::Refused { .. }))
}

/// Statements that other languages do not have, besides the words of the tables.
const STATEMENTS: &[&str] = &[
    "TRANS", "ATRANS", "ROT", "AROT", "CYCLE800", "CYCLE81", "CYCLE82", "CYCLE83", "CYCLE84",
    "CYCLE840", "CYCLE85", "CYCLE86", "CYCLE89", "MCALL", "EXTCALL", "RND", "CHR", "CHF", "SUPA",
    "GOTOF", "GOTOB", "GOTOC", "GOTOS", "ENDIF", "ENDWHILE", "ENDFOR", "ENDLOOP", "UNTIL", "DEF",
    "PROC", "RET", "REPEATB", "ORIWKS", "ORIMKS", "ORIAXES", "ORIVECT", "ORIPLANE",
];

/// Returns whether a word, in either case, is one of Sinumerik.
pub(crate) fn is_word(word: &str) -> bool {
    STATEMENTS.iter().any(|known| word.eq_ignore_ascii_case(known)) || use_of(word).is_some()
}

/// Returns whether a word is one of Sinumerik alone. Short words are words elsewhere, too, and count at the begin of a line.
pub(super) fn is_marker(word: &str, is_first: bool) -> bool {
    (word.len() > 3 || is_first && word.len() == 3) && is_word(word)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every word of the tables stands in the section of the manual, and once in the tables.
    #[test]
    fn the_manual_lists_the_words() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/controls.md");
        let text = std::fs::read_to_string(path).expect("the manual");
        let (_, section) = text.split_once("## Native programs of Sinumerik").expect("a section");
        let words = PASSED_OVER.iter().chain(REFUSED.iter().flat_map(|(words, ..)| *words));
        let mut seen = Vec::new();
        for word in words.chain(STATEMENTS) {
            let is_listed = section.split(|c: char| !(c.is_ascii_alphanumeric() || c == '_'));
            assert!(is_listed.clone().any(|listed| listed == *word), "{word} is not in {path}");
            assert!(!seen.contains(word), "{word} stands twice");
            seen.push(word);
        }
    }
}
