//! What speaks against the attributes by which an HDF5 dataset is read, to code, severity and sentence.

use super::{IssueCode as Code, Severity};

findings! {
/// A finding about the unit, scale or offset of a dataset.
pub enum AttributeFinding of Attribute {
    /// A group states another value than what stands nearer to the samples, each as `scale = 0.5`; harmless
    /// where its value does nothing.
    GroupDiffers { group: String, stated: String, nearer: String, is_harmless: bool }
        => if *is_harmless { (Code::Scale, Note, Nothing) } else { (Code::Scale, Warning, Contradiction) },
        ("the group {group} states {stated}; nearer to the samples stands {nearer}, which was taken: one of \
         the two is wrong, or the group's is for other datasets; correct the wrong one in a copy, or delete \
         that of the group where each dataset has its own");
    /// Reading would refuse them: the problem and its remedy.
    Refused(words: String) => (Code::Scale, Warning, Nothing),
        ("{words}");
}
}
