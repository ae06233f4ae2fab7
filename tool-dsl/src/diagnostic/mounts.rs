//! Mounts: files, and how they are joined.

use super::data::{Chain, FormattedNumber};
use super::table::kinds;

kinds! {
    /// Mounts: files and how they are joined.
    MountKind "T05" "Mounts"

    error T0501 ProfileAndMounts
        "profile beside mounts"
        message "a tool has a profile or mounts"
        help "drop one, or mount the profile as a file of its own"
        explain "Mounted files are joined into one outline, which leaves no room for another.";
    error T0502 FrameOfMounts
        "tip or spindle beside mounts"
        message "mounts bring their own tip and spindle"
        help "drop it: the tip is the first mount's, at z = 0"
        explain "Mounts are placed along the axis from the first one's tip, each by its own tip and spindle.";
    error T0503 MountsAlike { name: String }
        "two mounts of one name"
        message "two mounts are called `{name}`"
        help "give it another name"
        explain "The surfaces of a part carry its name: `cutter.flute`.";
    error T0504 NothingMounted
        "nothing mounted"
        message "nothing is mounted"
        help "write `mount \"FILE.tool\" as NAME;`"
        explain "A tool of mounts has at least one."
        without "a tool without a mount is none of mounts";
    error T0505 PartCalledCutting
        "part called `cutting`"
        message "no part is called `cutting`"
        help "give it another name"
        explain "Laws mean all cutting surfaces by `cutting`.";
    error T0506 CuttingMount
        "mount marked `cutting`"
        message "a mount is not `cutting`"
        help "drop it: each surface of the mounted file says so for itself"
        explain "A part has surfaces that cut and others that do not, as its file says.";
    error T0507 FirstMountPlaced
        "first mount with a place"
        message "the first mount keeps its place"
        help "drop `at`: its tip is the tool's, at z = 0"
        explain "The other mounts are placed from the first one's tip.";
    error T0508 NoPlace { name: String }
        "mount without a place"
        message "where along the axis does `{name}` begin?"
        help "write `at z = …`, from the first mount's tip"
        explain "All mounts but the first say where along the axis their tip lies.";
    error T0509 TooManyMounts { most: usize }
        "too many mounted files"
        message "more than {most} mounted files"
        help "write some of them as one file"
        explain "Files that mounted files mount count too."
        without "an example would have dozens of mounts";
    error T0510 NotTool { file: String }
        "mounted file that is no tool"
        message "`{file}` is not a `.tool` file"
        help "a mounted file begins with `tool Name {{`"
        explain "A file that begins otherwise is not read any further, and nothing of it is shown.";
    error T0511 NoFolder { file: String }
        "mount in a text from no file"
        message "where is `{file}`? this text is from no file"
        help "a mounted file is looked for beside the file that mounts it"
        explain "A text that a program hands to the compiler without a place has no folder to look in."
        without "a text in a file has a folder";
    error T0512 OutsideRoot { file: String, root: Option<String> }
        "mounted file outside the tool's folder"
        message (root) {
            Some(root) => "`{file}` does not lie below `{root}`",
            None => "`{file}` does not lie below the tool's folder",
        }
        help "move the file there; the program also takes a folder above both: `--root DIR`"
        explain "A tool from elsewhere may read no file that does not belong to it.";
    error T0513 Unreadable { file: String, error: String }
        "mounted file that cannot be read"
        message "cannot read `{file}`: {error}"
        help "the path is relative to the file that mounts it"
        explain "The file does not exist, may not be read, is too long, or is no UTF-8 text.";
    error T0514 MountsItself { file: String, chain: Chain }
        "file that mounts itself"
        message "`{file}` mounts itself: {chain}"
        help "mount a file that does not lead back to this one"
        explain "A file may mount files that mount others, but none of them the file itself.";
    error T0515 SolidMounted { file: String }
        "mounted solid"
        message "`{file}` is a solid without an axis and cannot be mounted"
        help "only outlines can be joined: mount a `tool`"
        explain "Mounts are joined along the axis of a solid of revolution.";
    error T0516 NoOutline { file: String, regions: bool }
        "mounted file without a profile"
        message (regions) {
            true => "`{file}` has regions but no profile and cannot be mounted",
            false => "`{file}` has no profile and cannot be mounted",
        }
        help "only outlines can be joined: write it as a `profile`"
        explain "The outlines of mounted files are joined into one, from which regions are derived.";
    error T0517 NotAbove { name: String, z: FormattedNumber, below: String, height: FormattedNumber }
        "mount not above the one before"
        message "`{name}` at z = {z} does not lie above `{below}` at z = {height}"
        help "mounts are listed from the tip up"
        explain "Each mount continues the outline of those before it, from a plane across the axis on.";
    error T0518 TooShort { below: String, z: FormattedNumber, top: FormattedNumber, length: FormattedNumber, first: bool }
        "part too short"
        message (first) {
            true => "`{below}` is {length} long and cannot stick out {z}",
            false => "`{below}` ends at z = {top} and does not reach z = {z}",
        }
        help "put it at z = {top} or below, or make `{below}` longer"
        explain "A part reaches at least the plane on which the next one begins.";
    error T0519 PointAtPlane { below: String, z: FormattedNumber }
        "part that is a point at the plane"
        message "`{below}` comes to a point at z = {z}"
        help "put the plane where there is something to hold"
        explain "At the plane on which the next part begins, this one has no radius.";
    error T0520 PlaneCutsTwice { below: String, z: FormattedNumber }
        "plane that cuts a part more than once"
        message "the plane z = {z} cuts `{below}` more than once"
        help "put the plane where the profile crosses it once"
        explain "Below the plane the lower part is kept, above it is dropped. A profile that comes back would be left in pieces.";
    error T0521 NoFace { file: String }
        "mounted file without a flat face"
        message "the first segment of `{file}` is not a flat face"
        help "what is mounted on another part begins with a face across the axis"
        explain "Two parts are joined at a plane across the axis, on which the upper one stands with a flat face.";
}
