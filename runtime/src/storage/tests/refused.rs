//! Tests with files that are not saved parts, are damaged, or contradict themselves.

use super::super::layout::{
    FileHeader, MAGIC, SectionHeader, Start, Surveyed, VERSION, checksums, lists, seal,
};
use super::*;
use crate::cloud::Sampling;
use nalgebra::Vector3;
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use std::mem::{offset_of, size_of};

#[test]
fn every_bit_is_guarded() {
    let mut bytes = saved(&small());
    for at in 0..bytes.len() {
        for bit in 0..8 {
            bytes[at] ^= 1 << bit;
            assert!(open(&bytes).is_err(), "bit {bit} of byte {at}");
            bytes[at] ^= 1 << bit;
        }
    }
    open(&bytes).expect("opened");
}

#[test]
fn bits_of_many_chunks_are_guarded() {
    let part = Part::from_cloud(
        &Cloud::sample(&cuboid(), Sampling::monte_carlo(40_000)).expect("a cloud"),
    );
    let mut bytes = saved(&part);
    let mut random = Pcg64::seed_from_u64(1);
    for _ in 0..300 {
        let at = random.next_u64() as usize % bytes.len();
        let bit = 1 << (random.next_u32() % 8);
        bytes[at] ^= bit;
        assert!(open(&bytes).is_err(), "byte {at}");
        bytes[at] ^= bit;
    }
    let last = bytes.len() - 1;
    bytes[last] ^= 1;
    let said = says(&bytes);
    assert!(said.contains("a.part is damaged: the checksum of the triangle ids of tree 0, bytes"));
    bytes[last] ^= 1;
    bytes[70] ^= 1;
    assert!(says(&bytes).contains("is damaged: the checksum of the header, bytes 0 to 3"));
}

#[test]
fn what_is_cut_off_or_too_long_is_refused() {
    let whole = saved(&small());
    for length in 1..whole.len() {
        let found = open(&whole[..length]);
        let Err(SavedError::Truncated { has, needs, .. }) = found else { panic!("{found:?}") };
        assert_eq!(has, length as u64);
        let known = length >= size_of::<Start>();
        assert_eq!(needs, if known { whole.len() } else { size_of::<Start>() } as u64);
    }
    let said = says(&whole[..1000]);
    let all = whole.len();
    assert_eq!(
        said,
        format!(
            "a.part is cut off: it has 1000 bytes and needs at least {all}: copy it again, or make \
             it again from the mesh"
        )
    );
    let long = [&whole[..], b"\0"].concat();
    assert!(matches!(open(&long), Err(SavedError::Trailing { .. })));
}

#[test]
fn says_what_a_file_is_instead() {
    let whole = saved(&small());
    let mut stl = vec![0; 84 + 50];
    stl[80] = 1;
    stl[0] = b'x';
    let sent = "changed on its way, as where it is sent as text: send it as binary";
    for (bytes, seems) in [
        (whole.iter().copied().filter(|byte| *byte != b'\r').collect(), sent),
        (
            whole
                .iter()
                .flat_map(|byte| [b'\r', *byte][usize::from(*byte != b'\n')..].to_vec())
                .collect(),
            sent,
        ),
        (String::from_utf8_lossy(&whole).into_owned().into_bytes(), sent),
        (whole.iter().map(|byte| byte & 127).collect(), sent),
        (b"solid x\nfacet".to_vec(), "an STL mesh (text)"),
        (stl, "an STL mesh (binary)"),
        (b"ply\nformat ascii 1.0\n".to_vec(), "a PLY file"),
        (b"# made by hand\nv 0 0 0\n".to_vec(), "an OBJ mesh"),
        (b"ISO-10303-21;".to_vec(), "a STEP file"),
        (b"PK\x03\x04".to_vec(), "a zip archive"),
        (b"version https://git-lfs.github.com/spec/v1\noid".to_vec(), "Git LFS"),
        (b"{\"part\": 1}".to_vec(), "a JSON file"),
        (b"<!DOCTYPE html>".to_vec(), "an XML or HTML file"),
        ("é".repeat(400).into_bytes(), "a text file"),
        (vec![0; 5000], "zeros, as a copy that was interrupted leaves them"),
        (vec![255; 5000], "a binary file of another program"),
        (b"\x01\x02\x03".to_vec(), "a binary file of another program"),
    ] {
        let said = says(&bytes);
        assert!(said.starts_with("a.part is no saved part: it seems to be "), "{said}");
        assert!(said.contains(seems), "{said}: {seems}");
    }
    let folder = tempfile::tempdir().expect("a folder");
    let empty = folder.path().join("empty.part");
    File::create(&empty).expect("a file");
    let said = Part::open(&empty).expect_err("it is empty").to_string();
    assert!(said.contains("it seems to be an empty file"), "{said}");
    let said = Part::open(folder.path()).expect_err("a folder").to_string();
    assert!(said.contains("it is no regular file: check the path"), "{said}");
    let missing = Part::open("no/such.part").expect_err("no such file");
    assert!(matches!(missing, SavedError::Unreadable { .. }));
}

#[test]
fn says_which_version_it_is_of() {
    let mut bytes = saved(&small());
    let start: Start = bytemuck::pod_read_unaligned(&bytes[..size_of::<Start>()]);
    let at = offset_of!(Start, version);
    for version in [VERSION + 1, 0] {
        bytes[at..at + 4].copy_from_slice(&version.to_le_bytes());
        assert!(matches!(open(&bytes), Err(SavedError::Damaged { .. })), "a flipped bit is none");
        seal(&mut bytes[..start.header as usize]);
        let said = says(&bytes);
        let newer = "of version 2, and versions up to 1 are read here: update this program";
        assert!(said.contains(if version == 0 { "no version 0" } else { newer }), "{said}");
    }
}

/// Recomputes all checksums, as a faulty program would write them.
fn reseal(bytes: &mut [u8], trees: usize, sections: usize) {
    let first = size_of::<Start>() + size_of::<Surveyed>() + trees * size_of::<FileHeader>();
    for k in 0..sections {
        let place = first + k * size_of::<SectionHeader>();
        let record = place..place + size_of::<SectionHeader>();
        let mut section: SectionHeader = bytemuck::pod_read_unaligned(&bytes[record.clone()]);
        let (at, length) = (section.at as usize, section.bytes as usize);
        let filled = at..at.saturating_add(length.min(1 << 32).next_multiple_of(ALIGN));
        if let Some(filled) = bytes.get(filled) {
            section.checksum = checksums(&[filled])[0];
            bytes[record].copy_from_slice(bytemuck::bytes_of(&section));
        }
    }
    let start: Start = bytemuck::pod_read_unaligned(&bytes[..size_of::<Start>()]);
    if let Some(header) = bytes.get_mut(..start.header as usize)
        && header.len() >= size_of::<Start>()
    {
        seal(header);
    }
}

/// Sets random bytes and corrects every checksum: each file is refused, or its part can be queried.
#[test]
fn no_file_with_right_checksums_leads_out_of_a_list() {
    let pose = |z: f64, axis| Pose::from_axis(Point3::new(4.0, 4.0, z), axis).expect("a pose");
    let poses = [pose(6.5, Vector3::z()), pose(-1.0, Vector3::x()), pose(1e9, Vector3::z())];
    let part =
        Part::from_cloud(&Cloud::sample(&cuboid(), Sampling::monte_carlo(300)).expect("a cloud"));
    let whole = saved(&part);
    let start: Start = bytemuck::pod_read_unaligned(&whole[..size_of::<Start>()]);
    let sections = lists(300).len();
    let mut random = Pcg64::seed_from_u64(1);
    let mut opened = [0; 2];
    for round in 0..10_000 {
        let mut bytes = whole.clone();
        for _ in 0..1 + random.next_u32() % 4 {
            // Half of the changes are in the header. They replace whole words, so that numbers become absurd.
            let within = if round % 2 == 0 { start.header as usize } else { bytes.len() };
            let at = random.next_u64() as usize % within / 4 * 4;
            let word = match random.next_u32() % 4 {
                0 => 0,
                1 => u32::MAX,
                2 => f32::INFINITY.to_bits(),
                _ => random.next_u32(),
            };
            bytes[at..at + 4].copy_from_slice(&word.to_le_bytes());
        }
        reseal(&mut bytes, 1, sections);
        let found = open(&bytes);
        opened[usize::from(found.is_ok())] += 1;
        if let Ok(part) = found {
            evaluations(&part, &poses);
            (0..part.tree().len()).for_each(|index| {
                std::hint::black_box(part.tree().point(index));
            });
        }
    }
    assert!(opened[0] > 1000 && opened[1] > 1000, "{opened:?}");
    // A box at an index without content.
    let mut part = part;
    part.levels[0].levels[0][0].centre = [[0.0; 16]; 3];
    assert!(says(&saved(&part)).contains("boxes or points of nothing: the program that wrote it"));
}

#[test]
fn garbage_is_refused() {
    let mut random = Pcg64::seed_from_u64(1);
    for round in 0..10_000 {
        let mut bytes = vec![0; random.next_u32() as usize % 3000];
        random.fill_bytes(&mut bytes);
        let start = size_of::<Start>();
        if round % 2 == 0 && bytes.len() > start {
            bytes[..16].copy_from_slice(&MAGIC);
            bytes[offset_of!(Start, version)..][..4].copy_from_slice(&VERSION.to_le_bytes());
            let header = (start + random.next_u32() as usize % 2000).min(bytes.len()) as u64;
            bytes[offset_of!(Start, header)..][..8].copy_from_slice(&header.to_le_bytes());
            let length = bytes.len() as u64;
            bytes[offset_of!(Start, file)..][..8].copy_from_slice(&length.to_le_bytes());
            bytes[offset_of!(Start, unit)..][..12].copy_from_slice(bytemuck::bytes_of(&[1u32; 3]));
            bytes[offset_of!(Start, unit) + 8] = round as u8 / 2 % 2;
            seal(&mut bytes[..header as usize]);
        }
        assert!(open(&bytes).is_err());
    }
}
