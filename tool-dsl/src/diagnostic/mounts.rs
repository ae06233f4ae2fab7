//! Mounts: files, and how they are joined.

use super::data::{FormattedNumber, MountChain};
use super::table::kinds;

kinds! {
    /// Mounts: files and how they are joined.
    MountKind "T05" "Mounts"

    error T0501 ProfileWithMounts
        "profile beside mounts"
        message "a tool has either a `profile` or mounts, not both"
        help "remove one of them, or move the profile to a file of its own and mount it"
        explain "The profiles of mounted files are joined into the tool's only profile.";
    error T0502 FrameWithMounts
        "`tip` or `spindle` beside mounts"
        message "a tool with mounts cannot set `tip` or `spindle`"
        help "remove it: the tip of the first mount is at z = 0"
        explain "Each mounted file sets its own tip and spindle. Mounts are placed along the axis, from the tip of the first one.";
    error T0503 DuplicateMount { name: String }
        "two mounts with the same name"
        message "two mounts are called `{name}`"
        help "rename one of them"
        explain "Surfaces of a mounted tool are named after the mount, as in `cutter.flute`.";
    error T0504 NoMount
        "no mount"
        message "this tool mounts no file"
        help "write `mount \"FILE.tool\" as NAME;`"
        explain "An assembly has at least one mount."
        without "a tool without a mount is not compiled as an assembly";
    error T0505 MountCalledCutting
        "mount called `cutting`"
        message "a mount cannot be called `cutting`"
        help "choose another name"
        explain "In laws, `cutting` stands for all cutting surfaces.";
    error T0506 CuttingMount
        "mount marked `cutting`"
        message "a mount cannot be marked `cutting`"
        help "remove `cutting`: the mounted file marks its own surfaces"
        explain "A mounted tool can have both cutting and non-cutting surfaces. Its file tells which are which.";
    error T0507 FirstMountWithPosition
        "first mount with a position"
        message "the first mount cannot have a position"
        help "remove `at`: the tip of the first mount is at z = 0"
        explain "The other mounts are placed from the tip of the first one.";
    error T0508 NoPosition { name: String }
        "mount without a position"
        message "mount `{name}` has no position along the axis"
        help "write `at z = …`, measured from the tip of the first mount"
        explain "Every mount except the first needs the z of its tip.";
    error T0509 TooManyMounts { limit: usize }
        "too many mounted files"
        message "more than {limit} mounted files"
        help "combine some of them in one file"
        explain "Files that are mounted by mounted files count too."
        without "an example would have dozens of mounts";
    error T0510 NotATool { file: String }
        "mounted file that is not a tool"
        message "`{file}` is not a `.tool` file"
        help "mount a file that begins with `tool Name {{`"
        explain "The compiler reads no more of a file that begins otherwise, and shows none of its text.";
    error T0511 NoFolder { file: String }
        "mount in a text without a file"
        message "cannot find `{file}`: this text does not come from a file"
        help "save the text as a file: paths of mounts are relative to it"
        explain "Paths of mounted files are relative to the file that mounts them. A text that a program passes to the compiler without a path has no such folder."
        without "the text of an example comes from a file";
    error T0512 OutsideRoot { file: String, root: Option<String> }
        "mounted file outside the tool's folder"
        message (root) {
            Some(root) => "`{file}` is outside the folder `{root}`",
            None => "`{file}` is outside the tool's folder",
        }
        help "move it into that folder, or pass `--root DIR` with a folder that contains both"
        explain "A tool may read only files below its folder, so that a tool from an unknown source cannot read others.";
    error T0513 Unreadable { file: String, error: String }
        "mounted file that cannot be read"
        message "cannot read `{file}`: {error}"
        help "check the path: it is relative to the file that mounts it"
        explain "The file does not exist, may not be read, is too long, or is not UTF-8 text.";
    error T0514 MountCycle { file: String, chain: MountChain }
        "file that mounts itself"
        message "`{file}` mounts itself: {chain}"
        help "mount a file that does not mount this one, directly or through others"
        explain "A mounted file may mount others, but none of the files through which it is mounted itself.";
    error T0515 MountedSolid { file: String }
        "mounted solid"
        message "`{file}` is a `solid` and cannot be mounted"
        help "mount a `tool` that has a `profile`"
        explain "Mounts are joined along the axis of a solid of revolution. A `solid` has no axis.";
    error T0516 NoMountedProfile { file: String, regions: bool }
        "mounted file without a profile"
        message (regions) {
            true => "`{file}` has regions but no profile and cannot be mounted",
            false => "`{file}` has no profile and cannot be mounted",
        }
        help "write the mounted tool as a `profile`"
        explain "The profiles of mounted files are joined into one, from which regions are derived.";
    error T0517 NotAbove { name: String, z: FormattedNumber, previous: String, previous_z: FormattedNumber }
        "mount not above the previous one"
        message "`{name}` at z = {z} is not above `{previous}` at z = {previous_z}"
        help "list the mounts from the tip up, each at a larger z"
        explain "Each mount continues the profile of the previous ones from a plane across the axis.";
    error T0518 TooShort { name: String, z: FormattedNumber, top: FormattedNumber, length: FormattedNumber, first: bool }
        "mounted tool too short"
        message (first) {
            true => "`{name}` is only {length} long and cannot stick out {z}",
            false => "`{name}` ends at z = {top} and does not reach z = {z}",
        }
        help "mount at z = {top} or below, or make `{name}` longer"
        explain "A mounted tool must reach the plane at which the next mount begins.";
    error T0519 ZeroRadiusAtPlane { name: String, z: FormattedNumber }
        "radius 0 at the mounting plane"
        message "`{name}` has radius 0 at z = {z}, where the next mount begins"
        help "mount at a z where `{name}` has a radius"
        explain "A mounted tool needs a radius at the plane at which the next mount begins.";
    error T0520 PlaneCutsTwice { name: String, z: FormattedNumber }
        "mounting plane that cuts a profile more than once"
        message "the plane z = {z} cuts `{name}` more than once"
        help "mount at a z where the profile crosses the plane once"
        explain "The lower tool is kept below the plane and cut off above it. A profile that crosses the plane again would leave separate pieces.";
    error T0521 NoFlatFace { file: String }
        "mounted file without a flat face"
        message "the first segment of `{file}` is not a flat face"
        help "begin the mounted profile with a line perpendicular to the axis"
        explain "Two mounted tools are joined at a plane across the axis, on which the upper one stands with a flat face.";
    warning T0522 ClampedEdge { name: String, z: FormattedNumber, surface: String, end: FormattedNumber }
        "holder that clamps a cutting surface"
        message "`{name}` begins at z = {z}, but `{surface}` cuts up to z = {end}"
        help "mount `{name}` at z = {end} or above, or shorten `{surface}`"
        explain "What lies above the plane of a mount is inside the mounted tool. A collet that clamps flutes is damaged, and so are the flutes.";
}
