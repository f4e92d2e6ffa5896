//! The columns of a record, declared once for writing and for reading.

/// Declares a row: its fields are the columns in their order, each with the reader of its cell. The first `$required`
/// columns are in every file of such rows, the others came later.
macro_rules! columns {
    (
        $(#[$about:meta])*
        $name:ident, $required:literal required:
        $($(#[$doc:meta])* $field:ident: $type:ty = $read:ident($($argument:expr),*),)*
    ) => {
        $(#[$about])*
        #[derive(Debug, Clone, PartialEq, serde::Serialize)]
        pub struct $name {
            $($(#[$doc])* pub $field: $type,)*
        }

        impl crate::record::read::Row for $name {
            const COLUMNS: &'static [&'static str] = &[$(stringify!($field)),*];
            const REQUIRED: usize = $required;

            fn read(cells: &crate::record::read::Cells) -> Result<Self, crate::error::Refusal> {
                Ok(Self { $($field: cells.$read(stringify!($field), $($argument),*)?,)* })
            }
        }
    };
}

pub(super) use columns;
