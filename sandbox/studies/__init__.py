"""Studies: claims, figures, comparisons, maps, the work-precision chart, limits of the methods, the experiment."""
