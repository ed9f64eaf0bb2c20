//! Findings on the attributes of an HDF5 dataset: code, severity and sentence of each.

use super::{IssueCode as Code, Severity};

findings! {
/// A finding about the unit, scale or offset of a dataset.
pub enum AttributeFinding of Attribute {
    /// A group states another value than the dataset or a group closer to it, each as `scale = 0.5`; harmless
    /// if its value has no effect.
    GroupDiffers { group: String, stated: String, nearer: String, is_harmless: bool }
        => if *is_harmless { (Code::Scale, Note, Nothing) } else { (Code::Scale, Warning, Contradiction) },
        ("the group {group} states {stated}; nearer to the samples stands {nearer}, which was taken: one of \
         the two is wrong, or the group's is for other datasets; correct the wrong one in a copy, or delete \
         that of the group where each dataset has its own");
    /// The reader would refuse the attributes: the problem and its remedy.
    Refused(words: String) => (Code::Scale, Warning, Nothing),
        ("{words}");
}
}
