//! Normal force on a corner from its height above the target, with the memory of its dent.

use crate::lab::data::CrushableEnd;

/// Damping of a corner that settles in its dent, as a share of the critical: it rests after some twenty
/// cycles.
const SETTLING_DAMPING: f64 = 0.05;

/// Phase of a corner; the force law is smooth within each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Phase {
    /// Above the target or its own dent.
    Free,
    /// Crushed deeper on the loading line.
    Loading,
    /// Crushed deeper at the yield force.
    Yielding,
    /// Coming out along the unloading line.
    Unloading,
    /// Returned before it left: on the unloading line either way, damped until it rests.
    ///
    /// The first unloading has no damping, so that k follows from the two stiffnesses.
    Settling,
}

/// Meaning of a change of phase for the drop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum CornerPassage {
    /// The corner touches.
    Touch,
    /// The corner leaves.
    Leave,
}

/// One corner: its force law and its dent.
#[derive(Debug, Clone, Copy)]
pub(super) struct CrushingCorner {
    pub(super) law: CrushableEnd,
    phase: Phase,
    /// Height at which the corner meets material, m.
    floor_m: f64,
    /// Greatest depth below that, m.
    deepest_m: f64,
    /// Force at that depth, N.
    peak_n: f64,
    /// Damping while it settles, N s/m.
    damping_n_s_m: f64,
}

impl CrushingCorner {
    /// A corner of a body of `mass_kg` without a dent, at the target or above it.
    pub(super) fn new(mut law: CrushableEnd, mass_kg: f64, touching: bool) -> Self {
        if let Some((_, stiffness_n_m)) = law.lock_up {
            // An end that unloads more softly than it was loaded would generate energy.
            law.unloading_n_m = law.unloading_n_m.max(law.loading_n_m + stiffness_n_m);
        }
        let phase = if touching { Phase::Loading } else { Phase::Free };
        let damping_n_s_m = 2.0 * SETTLING_DAMPING * (law.unloading_n_m * mass_kg).sqrt();
        Self { law, phase, floor_m: 0.0, deepest_m: 0.0, peak_n: 0.0, damping_n_s_m }
    }

    /// True if the corner is on the target.
    pub(super) fn touches(&self) -> bool {
        self.phase != Phase::Free
    }

    /// Stiffness that determines the time scale, N/m; a settling corner is left to the error control.
    pub(super) fn stiffness_n_m(&self) -> f64 {
        match self.phase {
            Phase::Free => 0.0,
            Phase::Unloading => self.law.unloading_n_m,
            Phase::Loading | Phase::Yielding | Phase::Settling => {
                self.law.loading_n_m + self.law.lock_up.map_or(0.0, |lock_up| lock_up.1)
            }
        }
    }

    /// True if the corner is past its greatest crush.
    pub(super) fn is_unloading(&self) -> bool {
        matches!(self.phase, Phase::Unloading | Phase::Settling)
    }

    /// Greatest crush in this contact so far, m.
    pub(super) fn crush_m(&self, height_m: f64) -> f64 {
        match self.phase {
            Phase::Free => 0.0,
            Phase::Loading | Phase::Yielding => self.floor_m - height_m,
            Phase::Unloading | Phase::Settling => self.deepest_m,
        }
    }

    /// Additional force of material that a crush of `depth_m` has locked up, N.
    fn locked_n(&self, depth_m: f64) -> f64 {
        self.law.lock_up.map_or(0.0, |(from_m, stiffness_n_m)| stiffness_n_m * (depth_m - from_m).max(0.0))
    }

    /// Force on the line of the phase, N; negative if the corner has left.
    fn line_n(&self, height_m: f64, rising_m_s: f64) -> f64 {
        let depth_m = self.floor_m - height_m;
        match self.phase {
            Phase::Free => 0.0,
            Phase::Loading => self.law.loading_n_m * depth_m + self.locked_n(depth_m),
            Phase::Yielding => self.yield_n() + self.locked_n(depth_m),
            Phase::Unloading => self.unloading_line_n(depth_m),
            Phase::Settling => self.unloading_line_n(depth_m) - self.damping_n_s_m * rising_m_s,
        }
    }

    fn unloading_line_n(&self, depth_m: f64) -> f64 {
        self.peak_n - self.law.unloading_n_m * (self.deepest_m - depth_m)
    }

    fn yield_n(&self) -> f64 {
        self.law.yield_n.unwrap_or(f64::INFINITY)
    }

    /// Normal force, N; the target only pushes.
    pub(super) fn normal_n(&self, height_m: f64, rising_m_s: f64) -> f64 {
        self.line_n(height_m, rising_m_s).max(0.0)
    }

    /// Two values that stay above zero while the phase lasts; the one that falls below decides the next
    /// phase.
    pub(super) fn phase_margins(&self, height_m: f64, rising_m_s: f64) -> [f64; 2] {
        match self.phase {
            Phase::Free => [height_m - self.floor_m, 1.0],
            Phase::Loading => {
                [-rising_m_s, self.yield_n() - self.law.loading_n_m * (self.floor_m - height_m)]
            }
            Phase::Yielding => [-rising_m_s, 1.0],
            Phase::Unloading => [self.line_n(height_m, rising_m_s), rising_m_s],
            Phase::Settling => {
                [self.line_n(height_m, rising_m_s), self.deepest_m - (self.floor_m - height_m)]
            }
        }
    }

    /// Changes to the phase that follows when margin number `which` has fallen below zero.
    pub(super) fn switch(&mut self, which: usize, height_m: f64) -> Option<CornerPassage> {
        match (self.phase, which) {
            (Phase::Free, _) => {
                self.phase = Phase::Loading;
                return Some(CornerPassage::Touch);
            }
            (Phase::Loading, 1) => self.phase = Phase::Yielding,
            (Phase::Loading | Phase::Yielding, _) => {
                self.deepest_m = self.floor_m - height_m;
                let crushing_n = (self.law.loading_n_m * self.deepest_m).min(self.yield_n());
                self.peak_n = crushing_n + self.locked_n(self.deepest_m);
                self.phase = Phase::Unloading;
            }
            (Phase::Unloading | Phase::Settling, 0) => {
                // The dent stays: the next touch is at its floor, and crushes further.
                self.phase = Phase::Free;
                self.floor_m = height_m;
                return Some(CornerPassage::Leave);
            }
            (Phase::Unloading, _) => self.phase = Phase::Settling,
            (Phase::Settling, _) => {
                let yielded = self.law.loading_n_m * self.deepest_m >= self.yield_n();
                self.phase = if yielded { Phase::Yielding } else { Phase::Loading };
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAW: CrushableEnd = CrushableEnd {
        loading_n_m: 1e6,
        unloading_n_m: 4e6,
        yield_n: Some(3e3),
        lock_up: None,
        footprint: 0.0,
    };

    #[test]
    fn locked_up_it_hardens_and_comes_back_no_softer() {
        let law = CrushableEnd { lock_up: Some((4e-3, 7e6)), ..LAW };
        let mut corner = CrushingCorner::new(law, 1000.0, true);
        corner.switch(1, -3e-3);
        assert!((corner.normal_n(-4e-3, 0.0) - 3e3).abs() < 1e-9);
        // 3000 N and 1 mm of 7 N/µm; then back along 8 N/µm, the steeper of 4 and 1 + 7.
        assert!((corner.normal_n(-5e-3, 0.0) - 1e4).abs() < 1e-9);
        corner.switch(0, -5e-3);
        assert!((corner.normal_n(-4.5e-3, 0.0) - 6e3).abs() < 1e-9);
        assert!(corner.is_unloading() && (corner.crush_m(-4.5e-3) - 5e-3).abs() < 1e-15);
    }

    #[test]
    fn the_force_follows_the_loading_the_plateau_and_the_unloading() {
        let mut corner = CrushingCorner::new(LAW, 1000.0, true);
        assert!((corner.normal_n(-2e-3, 0.0) - 2e3).abs() < 1e-9);
        assert!(corner.phase_margins(-2e-3, -1.0).iter().all(|w| *w > 0.0));
        assert!(corner.phase_margins(-3.1e-3, -1.0)[1] < 0.0);
        assert_eq!(corner.switch(1, -3e-3), None);
        assert!((corner.normal_n(-4e-3, 0.0) - 3e3).abs() < 1e-9);
        assert_eq!(corner.switch(0, -5e-3), None);
        // 3000 N at 5 mm, 4 N/µm back: 1000 N at 4.5 mm, nothing at 4.25 mm.
        assert!((corner.normal_n(-4.5e-3, 0.0) - 1e3).abs() < 1e-9);
        assert!(corner.phase_margins(-4.2e-3, 1.0)[0] < 0.0);
        assert_eq!(corner.switch(0, -4.25e-3), Some(CornerPassage::Leave));
        assert!(!corner.touches());
        assert!(corner.phase_margins(-4.3e-3, -1.0)[0] < 0.0);
        // It meets the floor of its dent and crushes anew.
        assert_eq!(corner.switch(0, -4.25e-3), Some(CornerPassage::Touch));
        assert!((corner.normal_n(-5.25e-3, 0.0) - 1e3).abs() < 1e-9);
    }

    #[test]
    fn fallen_back_in_its_dent_a_corner_is_damped_and_pressed_beyond_it_loads_on() {
        let mut corner = CrushingCorner::new(LAW, 1000.0, true);
        corner.switch(0, -1e-3);
        assert!((corner.normal_n(-0.9e-3, 0.1) - 600.0).abs() < 1e-9, "the way out is not damped");
        assert!(corner.phase_margins(-0.9e-3, -0.1)[1] < 0.0);
        assert_eq!(corner.switch(1, -0.9e-3), None);
        // c = 0.1 √(4e6 · 1000) = 6325 N s/m.
        assert!((corner.normal_n(-0.9e-3, -0.01) - 663.2).abs() < 0.1);
        assert!(corner.phase_margins(-1.1e-3, -1.0)[1] < 0.0);
        corner.switch(1, -1e-3);
        assert!((corner.normal_n(-2e-3, -1.0) - 2e3).abs() < 1e-9);
    }
}
