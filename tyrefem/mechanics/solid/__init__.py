"""Large-displacement mechanics of the cross-section: compounds, cord layers, inflation."""
