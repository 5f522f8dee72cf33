//! What pictures and masks of a few squares look like, against closed forms.

mod level;
mod lights;
mod surfaces;
