//! Where on its cutting surfaces a tool can touch a face.

use crate::tool::{Card, Circle};
use nalgebra::{Point3, Vector3};
use std::f64::consts::PI;

/// Places of the profile where a cutting surface bulges out, each with the normals that it has there, or,
/// at a corner, that it may be touched along.
#[derive(Clone, Debug)]
pub(crate) struct Sites {
    sites: Vec<Site>,
    /// How far the tool reaches.
    size: f64,
}

/// A tool that touches a face.
pub(crate) struct Contact {
    /// Where its tip is.
    pub(crate) tip: Point3<f64>,
    /// The place of its half plane that touches, a hair inside of the surfaces on either side of it. Both touch, so
    /// that a contact is as nice as the less nice of them.
    pub(crate) within: [[f64; 2]; 2],
}

/// An arc, or a corner as an arc of no radius; lengths in the part's unit.
#[derive(Clone, Copy, Debug)]
struct Site {
    centre: [f64; 2],
    radius: f64,
    /// Between which angles of the half plane, from d toward z, its normals lie.
    angles: [f64; 2],
    /// Into a corner, nearer to what is before it and to what is after it; of an arc that is the opposite of
    /// the normal.
    inward: Option<[[f64; 2]; 2]>,
}

/// A part of a circle, or of the tool, that rounding stays below by far.
const SAME: f64 = 1e-9;

impl Sites {
    /// Those of a tool, its unit of length in the part's.
    pub(crate) fn new(card: &Card, length: f64) -> Sites {
        let cuts = |surface: usize| card.surfaces[surface].cutting;
        let mut sites = Vec::new();
        // The half plane beyond the axis is the mirror image.
        let mut before = card.outline.first().map(|first| {
            let [d, z] = heading(first.from, first.to, first.circle, 0);
            ([d, -z], cuts(first.surface))
        });
        for piece in card.outline.iter() {
            let [start, end] = [0, 1].map(|end| heading(piece.from, piece.to, piece.circle, end));
            let cutting = cuts(piece.surface);
            if let Some((last, cut)) = before
                && cut
                && cutting
            {
                let turn = cross(last, start).atan2(dot(last, start));
                if turn > SAME {
                    let from = normal(last);
                    // The corner's material is half a turn less `turn` wide, about the opposite of the
                    // normals' middle.
                    let into = |side: f64| {
                        let (sine, cosine) =
                            (from + 0.5 * turn + side * 0.25 * (PI - turn)).sin_cos();
                        [-cosine, -sine]
                    };
                    sites.push(Site {
                        centre: piece.from.map(|part| part * length),
                        radius: 0.0,
                        angles: [from, from + turn],
                        inward: Some([into(1.0), into(-1.0)]),
                    });
                }
            }
            if let Some(Circle { centre, radius, convex: true }) = piece.circle
                && cutting
            {
                let from = normal(start);
                let turn = (normal(end) - from).rem_euclid(2.0 * PI);
                sites.push(Site {
                    centre: centre.map(|part| part * length),
                    radius: radius * length,
                    angles: [from, from + turn],
                    inward: None,
                });
            }
            before = Some((end, cutting));
        }
        Sites { sites, size: card.size() * length }
    }

    /// How far from the tip any of them is.
    pub(crate) fn reach(&self) -> f64 {
        let far = |site: &Site| site.centre[0].hypot(site.centre[1]) + site.radius;
        self.sites.iter().map(far).fold(0.0, f64::max)
    }

    /// The contacts of a face with a tool whose axis has a direction: the face has a place and an outward
    /// normal, and the tool's own is the opposite there.
    pub(crate) fn contacts(
        &self,
        place: Point3<f64>,
        normal: Vector3<f64>,
        axis: Vector3<f64>,
    ) -> impl Iterator<Item = Contact> {
        let up = -normal.dot(&axis);
        let across = -normal - axis * up;
        let out = across.norm();
        let angle = up.atan2(out);
        self.sites.iter().filter_map(move |site| {
            let [from, to] = site.angles;
            // Both are angles of the half plane, or a little beyond its ends.
            let off = (angle - from + SAME).rem_euclid(2.0 * PI) - SAME;
            if off > to - from + SAME {
                return None;
            }
            let touched = [site.centre[0] + site.radius * out, site.centre[1] + site.radius * up];
            // Which way is out is not known where a face is square to the axis.
            if out < SAME && touched[0] > SAME * self.size {
                return None;
            }
            let way = if out > 0.0 { across / out } else { across };
            let inward = site.inward.unwrap_or([[-out, -up]; 2]);
            Some(Contact {
                tip: place - way * touched[0] - axis * touched[1],
                within: inward.map(|way| [0, 1].map(|k| touched[k] + SAME * self.size * way[k])),
            })
        })
    }
}

/// The direction of travel at the beginning or end of a piece.
fn heading(from: [f64; 2], to: [f64; 2], circle: Option<Circle>, end: usize) -> [f64; 2] {
    let Some(Circle { centre, convex, .. }) = circle else {
        return unit([to[0] - from[0], to[1] - from[1]]);
    };
    let at = if end == 0 { from } else { to };
    let [d, z] = unit([at[0] - centre[0], at[1] - centre[1]]);
    if convex { [-z, d] } else { [z, -d] }
}

/// The angle of the outward normal of what goes in a direction, its material on the left.
fn normal([d, z]: [f64; 2]) -> f64 {
    (-d).atan2(z)
}

fn unit(way: [f64; 2]) -> [f64; 2] {
    let far = way[0].hypot(way[1]);
    way.map(|part| part / far)
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

#[cfg(test)]
mod tests;
